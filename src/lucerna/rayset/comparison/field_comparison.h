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

/// For each of `cells_um` (> 0, else UsageError). Rays along the plane have no share. Cost: about 0.3 us a
/// ray and cell size; 24 bytes a ray.
std::vector<PlaneDifference> focus_plane_differences(const Views& views, const RayBlock& reference,
                                                     const RayBlock& test, std::span<const double> cells_um);

/// Near, middle and far field of two ray sets.
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
enum class Viewpoint { front, side };  // against a; against the view frame's x axis
std::string_view to_string(Viewpoint from);

/// Nothing where fewer than 1000 of the reference's rays go that way.
std::optional<LuminanceImage> luminance_image(const Views& views, const RayBlock& reference,
                                              const RayBlock& test, Viewpoint from);

}  // namespace lucerna
