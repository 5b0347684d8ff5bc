// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/bounding_surface.h"
#include "lucerna/rays.h"

namespace lucerna {

/// What the starts of a ray set look like. `scattered` represents everything else: egg-shaped hulls, volumes.
enum class StartShape { point, line, surface, scattered };

/// Where the rays of a file start, as far as the rays say.
struct SurfaceGuess {
  StartShape shape = StartShape::scattered;
  /// For `surface`: which one, placed, of any tilt; a plane's +z points to where most flux goes. Else of kind
  /// `none`.
  BoundingSurface surface;
  /// Share of the flux (of the rays, if none has flux) that starts within `tolerance_mm` of it; 1 for point
  /// and line.
  double share = 0.0;
  double tolerance_mm = 0.0;
  /// For `point` and `line`: the mean start, and the line's direction.
  Vec3 point_mm;
  Direction line;
};

/// Guesses the bounding surface. A surface must hold `min_share` of the starts; of several that hold nearly
/// as many (3 %) the simplest is taken: plane, sphere, cylinder, box. Tolerance: 1e-4 of the extent's
/// diagonal, and what float32 can resolve. Planes, spheres and circles are found by random sample consensus
/// (Fischler and Bolles 1981, fixed seed) among 4096 of the rays and refined by least squares; cylinder axes
/// and box faces are sought along the world's axes, the starts' principal axes and the planes found. Cost:
/// some 50 ms, whatever the number of rays. Deterministic.
SurfaceGuess guess_surface(const RayBlock& rays, double min_share = 0.9);

/// "98.2 % of the flux starts on a plane through (0, 0, 0.02) mm with normal (0, 0, 1)".
std::string describe(const SurfaceGuess& guess);

}  // namespace lucerna
