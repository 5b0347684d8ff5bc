// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lucerna/ray_comparison.h"

namespace lucerna {

/// Illuminance where the lines cross the focus plane, in square cells, all of them however far out.
struct PlaneDifference {
  double cell_um = 0.0;
  /// Sum of |q - p| over all cells, with shares p of the reference's and q of the test's flux: 0 equal, 2
  /// nothing in common.
  double l1 = 0.0;
  /// The same for all rays of both, dealt out anew at random to two sets of these sizes: what counting noise
  /// alone gives.
  double floor = 0.0;
};

/// Cell sizes of the comparison, um.
inline constexpr std::array<double, 5> kFocusCells_um{12.0, 24.0, 48.0, 96.0, 240.0};

/// For each of `cells_um` (> 0, else UsageError). Rays along the plane have no share. Cost: about 0.3 us a
/// ray and cell size; 24 bytes a ray.
std::vector<PlaneDifference> focus_plane_differences(const Views& views, const RayBlock& reference,
                                                     const RayBlock& test, std::span<const double> cells_um);

/// Normalised cross-correlation of two pictures (Pearson's coefficient of their cells' shares): 1 where they
/// have the same pattern, whatever its scale.
struct CrossCorrelation {
  double value = 0.0;
  /// What counting noise leaves of 1 between two sets of the same source.
  double noise_limit = 1.0;
};

/// Of the near plane (32 x 32), a middle plane (64 x 64: as far beyond the near plane as three radii of the
/// source, at least 3 mm) and the far field (48 x 96): the set of measures of Rotscholl et al., Opt. Express
/// 24, A1597 (2016). Absent where the reference has nothing to see there.
struct FieldCorrelations {
  std::optional<CrossCorrelation> near, mid, far;
  double mid_plane_mm = 0.0;  // z in the view frame
};
FieldCorrelations field_correlations(const ViewCounts& reference, const ViewCounts& test,
                                     const RayBlock& reference_rays, const RayBlock& test_rays);

/// A light source as it looks from afar: mean luminance over directions within `kLookCone_rad` of one, by
/// place on the plane across it through the focus.
struct LuminanceImage {
  static constexpr std::size_t kCells = 64;
  ViewWindow window;  // square, mm, x then y across the direction of view
  /// Luminance per flux, 1/(mm^2 sr), of reference and test; the last is light outside the window, as a share
  /// of the whole.
  std::vector<double> reference, test;
};
inline constexpr double kLookCone_rad = 0.2617993877991494;  // 15 degrees

/// Where to look from.
enum class LookFrom { front, side };  // against a; against the view frame's x axis
std::string_view to_string(LookFrom from);

/// Nothing where fewer than 1000 of the reference's rays go that way.
std::optional<LuminanceImage> luminance_image(const Views& views, const RayBlock& reference,
                                              const RayBlock& test, LookFrom from);

}  // namespace lucerna
