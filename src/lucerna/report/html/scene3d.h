// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "lucerna/random.h"
#include "lucerna/scene.h"

namespace lucerna {

/// What the 3D view shows of a run.
struct Scene3dOptions {
  std::uint64_t seed = 1;
  SequenceKind sequence = SequenceKind::sobol;
  std::uint64_t first_ray = 0;
  /// Rays that are drawn, and starts of rays that make up the picture of the sources.
  std::uint64_t rays = 300, source_points = 2000;
};

/// A scene as data for assets/scene3d.js, in the luminaire frame, mm. One object:
/// `radius_mm` (of mirrors, bodies, glasses and sources about `centre_mm`), `mirrors[{name rings spokes
/// position normal slope_deg curvature_per_mm}]` (vertices ring after ring from the hole outwards, `spokes`
/// to a ring, or any triangles with `index` instead; slope is the angle between the normal and the mirror's
/// axis, curvature the mean of the two principal ones), `bodies[{name position index thinned}]` (triangles,
/// at most kMaxBodyTriangles: finer meshes have their vertices joined on a grid), `glasses[{name position
/// index}]` (closed solids, seen from outside counterclockwise), `source{position}` and `rays{count position
/// bounces}` (segments of two points; `bounces` counts the reflections before each, RayPath::reflections;
/// light that leaves is drawn for 1.2 `radius_mm` more). Arrays are base64_floats and base64_counts
/// (html_text.h), `bounces` plain numbers. Curvatures are central differences of the exact gradient over 1e-4
/// of the aperture's radius. Throws InputError on a bad scene. About 150 KB for a mirror.
inline constexpr std::size_t kMaxBodyTriangles = 20'000;
nlohmann::ordered_json scene3d_json(const Scene& scene, const Scene3dOptions& options = {});

}  // namespace lucerna
