// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/intensity.h"
#include "lucerna/photometry/formats/photometric_text.h"

namespace lucerna {

/// A grid as a file lists it: Type C, planes and gammas as stored, values in cd, plane after plane. Sizes
/// agree and counts are at least 1 plane and 2 gammas.
struct ListedGrid {
  std::vector<double> planes_deg, gammas_deg, cd;
  std::size_t planes_line = 0, gammas_line = 0, values_line = 0;  ///< where they stand in the file
};

/// Angles that are this close are one: files print them with 1 to 3 decimals.
inline constexpr double kEqualAngle_deg = 1e-4;

/// What the stored planes stand for.
enum class ListedSymmetry {
  rotational,   ///< one plane
  full,         ///< 0 .. below 360, or with the plane at 360 again
  half_0_180,   ///< 0 .. 180, mirrored on C0-C180
  half_90_270,  ///< 90 .. 270, mirrored on C90-C270
  half_270_90,  ///< 270 .. 360 .. 450 (or -90 .. 90), mirrored on C90-C270
  quarter,      ///< 0 .. 90, mirrored on both
};

/// The full Type C grid: gammas completed to 0 or 90 and 90 or 180, planes mirrored, the closing plane at 360
/// merged with the one at 0, nadir and zenith rows evened out, negative values set to 0; each that breaks a
/// rule goes to `log`. Fails where angles do not ascend or the planes do not span what `symmetry` needs.
/// `nadir_spread` receives (max - min) / mean of the nadir row, as read.
IntensityDistribution expanded(ListedGrid grid, ListedSymmetry symmetry, RepairLog& log,
                               double& nadir_spread);

}  // namespace lucerna
