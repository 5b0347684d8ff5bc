// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/trace.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/detectors/plane_bins.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/glass_tracer.h"
#include "lucerna/trace/engines/ray_colours.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/engines/solids_apart.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

/// What one task works with.
struct TraceScratch {
  RayBlock rays;
  /// Their wavelengths, if the scene asks for them, else 0.
  std::vector<float> wavelength_nm;
  /// Rays that left, in the order of their numbers, if the scene keeps them; weights in mean rays.
  RayBlock out_rays;
};

/// What `trace` drives: a scene made ready (hierarchies built, frames inverted) and a way to send one run of
/// rays through it. Shared by all threads, never changed.
class TraceEngine {
 public:
  explicit TraceEngine(const Scene& scene)
      : bodies_(scene.bodies),
        glasses_(scene.glasses, scene.solids),
        colours_(scene),
        keep_rays_(!scene.ray_detectors.empty()) {
    body_count_ = scene.bodies.size();
    glass_count_ = scene.glasses.size() + scene.solids.size();
    check_apart(scene);
    for (const FarFieldDetector& d : scene.far_fields) far_fields_.push_back(FarFieldGrid::counted(d));
    for (const PlaneDetector& d : scene.planes) planes_.emplace_back(d);
    for (const LuminanceDetector& d : scene.luminances) planes_.emplace_back(d);
  }
  virtual ~TraceEngine() = default;

  /// What TraceResult::isa says.
  virtual std::string isa() const = 0;

  /// Draws the rays of `run` and adds all that becomes of them to `tally`.
  virtual void trace_run(const SourceRun& run, TraceScratch& scratch, Tally& tally) const = 0;

  /// A tally with room for all causes and detectors.
  Tally empty_tally() const {
    Tally t;
    t.absorbed.resize(kMirrorLosses + body_count_ + glass_count_);
    t.lost.resize(kLostCauses);
    t.lost_rays.resize(kLostCauses);
    for (const FarFieldGrid& grid : far_fields_) t.bins.emplace_back(grid.size());
    for (const PlaneBins& bins : planes_) t.bins.emplace_back(bins.size());
    return t;
  }

 protected:
  /// The wavelengths of the rays of `run`.
  void emit_wavelengths(const SourceRun& run, SequenceKind kind, TraceScratch& scratch) const {
    scratch.wavelength_nm.resize(run.count);
    colours_.emit(run.source, Sequence(kind, run.sequence_seed), run.first, scratch.wavelength_nm);
  }

  /// Is there any detector that `leave` serves?
  bool looks_at_places() const {
    return keep_rays_ || !planes_.empty() ||
           std::any_of(far_fields_.begin(), far_fields_.end(), [](const auto& f) { return f.tent(); });
  }

  /// Gives the last leg of a ray to all detectors but far fields of hard bins. `quanta` is what it carries.
  void leave(const Ray& ray, std::int64_t quanta, TraceScratch& scratch, Tally& tally) const {
    for (std::size_t d = 0; d < far_fields_.size(); ++d) {
      if (far_fields_[d].tent()) far_fields_[d].add_tent(ray.direction, quanta, tally.bins[d].data());
    }
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      if (const auto cell = planes_[i].cell(ray)) tally.bins[far_fields_.size() + i][*cell] += quanta;
    }
    if (!keep_rays_) return;
    RayBlock& out = scratch.out_rays;
    out.resize(out.size() + 1);
    out.set(out.size() - 1, ray);
    out.weight.back() = static_cast<float>(static_cast<double>(quanta) / kQuantaPerRay);
  }

  const BodyTracer& bodies() const { return bodies_; }
  const GlassTracer& glasses() const { return glasses_; }
  /// Where Tally::absorbed counts what glass `i` keeps; solids follow the cover glasses.
  std::size_t glass_cause(std::size_t i) const { return kMirrorLosses + body_count_ + i; }
  /// As they count (FarFieldGrid::counted).
  const std::vector<FarFieldGrid>& far_fields() const { return far_fields_; }

 private:
  BodyTracer bodies_;
  GlassTracer glasses_;
  RayColours colours_;
  std::size_t body_count_ = 0, glass_count_ = 0;
  std::vector<FarFieldGrid> far_fields_;
  std::vector<PlaneBins> planes_;
  bool keep_rays_;
};

/// EngineKind::reference. Scene and numbering must outlive it.
std::unique_ptr<TraceEngine> make_reference_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options);

/// EngineKind::fast. Scene and numbering must outlive it.
std::unique_ptr<TraceEngine> make_wavefront_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options);

}  // namespace lucerna
