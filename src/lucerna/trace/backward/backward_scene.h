// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/source/emitters/luminance_source.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/glass_tracer.h"
#include "lucerna/trace/engines/mirror_tracer.h"
#include "lucerna/trace/kernels/slope_error.h"

namespace lucerna {

/// Why light cannot be followed backward through a scene; empty if it can. Not: sources without a known
/// luminance (ray files, clusters, some emitters), swept curves and facets, mirrors that scatter, bodies that
/// reflect, solids, several cover glasses.
std::string no_backward_reason(const Scene& scene);

/// How light leaves a luminaire: past its cover glass or through it, or reflected by it at last.
enum class Exit { onward, off_glass };

/// A scene made ready to follow light backward: luminance is kept along a line and multiplied by the
/// reflectance at each mirror, and at a cover glass by what it lets through or reflects, so what arrives on a
/// line is what the sources give off on the lines that it came by. The exact surfaces, in double. Immutable
/// and thread safe; the scene must outlive it.
class BackwardScene {
 public:
  struct Mirror {
    const PlacedReflector* placed;
    MirrorTracer tracer;
    Frame mirror_from_world;
    double slope_error_rad;
  };
  struct Source {
    const LuminanceSource* light;
    Frame world_from_source, source_from_world;
    double flux;
  };
  static constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  /// Memory that a thread reuses.
  using Scratch = std::vector<LineLight>;

  /// Throws InputError with `no_backward_reason`.
  BackwardScene(const Scene& scene, int max_bounces);

  const std::vector<Mirror>& mirrors() const { return mirrors_; }
  const std::vector<Source>& sources() const { return sources_; }
  /// All light leaves by one of these.
  std::span<const Exit> exits() const;
  /// The direction of light before the last cover glass, if it leaves along `out`.
  Direction direction_before(Exit exit, const Direction& out) const;

  /// Luminance of the light that leaves a mirror at `point` (on its front) in the direction `out`: what
  /// arrives there, reflected. flux / (mm^2 sr), in the sources' unit. `normal` is the surface's, in the
  /// luminaire frame; by Exit::off_glass it is reflected once more after the mirror; `key` numbers the slope
  /// errors and the ways through the glass.
  double reflected_luminance(const Mirror& mirror, const Vec3& point, const Direction& normal,
                             const Direction& out, Exit exit, ReflectionKey key, Scratch& scratch) const;

  /// Luminance that one source sends along the line of `ray` and out of the luminaire, from places on it
  /// before `end_mm`. `key` numbers the ways through the glass.
  double direct_luminance(const Source& source, const Ray& ray, Exit exit, const ReflectionKey& key,
                          Scratch& scratch, double end_mm = kNoEnd) const;

  /// Luminance of all light that leaves the luminaire along a line from places before `end_mm`. `key` as
  /// above. The scene must have no cover glass.
  double leaving_luminance(const Ray& line, ReflectionKey key, Scratch& scratch,
                           double end_mm = kNoEnd) const;

  /// Share of the light from `point` along `start` that leaves the luminaire by an exit; its direction is
  /// then `start`, or for Exit::off_glass `start` reflected. `returning`: it met a mirror or the glass
  /// before.
  double leaving_share(const Vec3& point, const Direction& start, Exit exit, bool returning,
                       const ReflectionKey& key) const;

 private:
  struct Hit;
  struct Step {
    Ray backward;
    double share = 0.0;
    bool reflected = true;
  };
  std::optional<Hit> nearest(const Ray& ray) const;
  Step step_back(const Hit& at, const ReflectionKey& key, const Ray& backward) const;
  bool escapes(const Ray& ray, bool returning) const;
  double emitted_on(const Ray& backward, double reach_mm, Scratch& scratch) const;

  int max_bounces_;
  std::vector<Mirror> mirrors_;
  std::vector<Source> sources_;
  BodyTracer bodies_;
  GlassTracer glasses_;
};

}  // namespace lucerna
