// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lucerna/rayset/ray_block.h"
#include "lucerna/trace/ray_numbering.h"
#include "lucerna/trace/tally.h"
#include "lucerna/trace/trace.h"

namespace lucerna {

/// What `trace` drives: a scene made ready (hierarchies built, frames inverted) and a way to send one run of
/// rays through it. Shared by all threads, never changed.
class TraceEngine {
 public:
  explicit TraceEngine(const Scene& scene) {
    for (const FarFieldDetector& d : scene.far_fields) far_fields_.emplace_back(d);
  }
  virtual ~TraceEngine() = default;

  /// What TraceResult::isa says.
  virtual std::string isa() const = 0;

  /// Draws the rays of `run` into `rays` (scratch) and adds all that becomes of them to `tally`.
  virtual void trace_run(const SourceRun& run, RayBlock& rays, Tally& tally) const = 0;

  /// A tally with room for all causes and detectors.
  Tally empty_tally() const {
    Tally t;
    t.absorbed.resize(kMirrorLosses);
    t.lost.resize(kLostCauses);
    t.lost_rays.resize(kLostCauses);
    for (const FarFieldGrid& grid : far_fields_) t.bins.emplace_back(grid.size());
    return t;
  }

 protected:
  const std::vector<FarFieldGrid>& far_fields() const { return far_fields_; }

 private:
  std::vector<FarFieldGrid> far_fields_;
};

/// EngineKind::reference. Scene and numbering must outlive it.
std::unique_ptr<TraceEngine> make_reference_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options);

/// EngineKind::fast. Scene and numbering must outlive it.
std::unique_ptr<TraceEngine> make_wavefront_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options);

}  // namespace lucerna
