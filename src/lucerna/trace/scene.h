// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lucerna/core/frame.h"
#include "lucerna/reflector/reflector.h"
#include "lucerna/source/ray_source.h"
#include "lucerna/trace/body.h"
#include "lucerna/trace/cover_glass.h"
#include "lucerna/trace/far_field.h"
#include "lucerna/trace/plane_detector.h"
#include "lucerna/trace/reflectance.h"

namespace lucerna {

/// A source of light in the luminaire frame.
struct PlacedSource {
  std::shared_ptr<const RaySource> rays;
  Frame world_from_source;
  /// Overrides the source's own flux, in its own unit; > 0.
  std::optional<double> flux;

  double total_flux() const { return flux ? *flux : rays->flux(); }
};

/// The flux of all sources together, in their common unit.
double total_flux(std::span<const PlacedSource> sources);

/// A mirror in the luminaire frame. The side towards its +z reflects, the other absorbs.
struct PlacedReflector {
  Reflector reflector;
  Frame world_from_reflector;
  Reflectance reflectance{1.0};
  /// Standard deviation of the surface normal's tilt about each of two perpendicular axes, Gaussian; >= 0.
  /// Every reflection draws its own tilt.
  double slope_error_mrad = 0.0;
};

/// All that light can meet, and what looks at it. Plain data; `trace` checks it.
struct Scene {
  std::vector<PlacedSource> sources;
  std::vector<PlacedReflector> reflectors;
  std::vector<FarFieldDetector> far_fields;
  std::vector<PlaneDetector> planes;
  std::vector<LuminanceDetector> luminances;
  /// With any of these all rays that leave are kept, as TraceResult::out_rays: 28 bytes a ray.
  std::vector<RayDetector> ray_detectors;
  std::vector<Body> bodies;
  std::vector<CoverGlass> glasses;
};

/// Share of a source's rays (of its first 4096) that start behind a mirror: within its aperture, on the side
/// of its back. A source that is partly behind reaches through the mirror.
double share_behind(const PlacedSource& source, const PlacedReflector& mirror);

/// Throws InputError if the scene cannot be traced: no source, a flux that is not above 0, lm and W together,
/// a detector whose steps do not divide the circle, two detectors of one name.
void check(const Scene& scene);

}  // namespace lucerna
