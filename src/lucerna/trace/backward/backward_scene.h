// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/source/emitters/luminance_source.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/mirror_tracer.h"
#include "lucerna/trace/kernels/slope_error.h"

namespace lucerna {

/// Why light cannot be followed backward through a scene; empty if it can. Not: sources without a known
/// luminance (ray files, clusters, some emitters), swept curves and facets, bodies that reflect, cover
/// glasses.
std::string no_backward_reason(const Scene& scene);

/// A scene made ready to follow light backward: luminance is kept along a line and multiplied by the
/// reflectance at each mirror, so what arrives on a line is what the sources give off on the lines that it
/// came by. The exact surfaces, in double. Immutable and thread safe; the scene must outlive it.
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

  /// Luminance of the light that leaves a mirror at `point` (on its front) in the direction `out`: what
  /// arrives there, reflected. flux / (mm^2 sr), in the sources' unit. `normal` is the surface's, in the
  /// luminaire frame; `key` numbers the slope errors.
  double reflected_luminance(const Mirror& mirror, const Vec3& point, const Direction& normal,
                             const Direction& out, ReflectionKey key, Scratch& scratch) const;

  /// Luminance that one source sends along the line of `ray` to infinity, past everything, from places on it
  /// before `end_mm`.
  double direct_luminance(const Source& source, const Ray& ray, Scratch& scratch,
                          double end_mm = kNoEnd) const;

  /// Luminance of all light that leaves the luminaire along a line from places before `end_mm`. `key` as
  /// above.
  double leaving_luminance(const Ray& line, ReflectionKey key, Scratch& scratch,
                           double end_mm = kNoEnd) const;

  /// Does light from `point` along `out` leave the luminaire? `returning`: it was reflected before.
  bool escapes(const Vec3& point, const Direction& out, bool returning) const;

 private:
  struct Hit;
  std::optional<Hit> nearest(const Ray& ray) const;
  double emitted_on(const Ray& backward, double reach_mm, Scratch& scratch) const;

  int max_bounces_;
  std::vector<Mirror> mirrors_;
  std::vector<Source> sources_;
  BodyTracer bodies_;
};

}  // namespace lucerna
