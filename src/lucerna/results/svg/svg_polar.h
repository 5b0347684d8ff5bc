// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lucerna/intensity.h"
#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// What a polar diagram shows beside its curves.
struct PolarOptions {
  std::string title{};                   ///< above the diagram; UTF-8
  std::optional<double> lamp_flux_lm{};  ///< if given, rings are in cd/klm of this flux instead of cd
  const IntensityDistribution* reference = nullptr;  ///< a target to draw behind, in grey; not owned
  std::string reference_name = "target";
  /// Standard errors of the values (layout of `cd`): their 95 % intervals are drawn as a band. Not owned.
  std::span<const double> standard_error{};
  /// Written below instead of what the grid's values give.
  std::optional<DrawnFigures> figures{};
};

/// A polar intensity diagram as an SVG document, the way the trade draws it: gamma 0 at the bottom, C0 and
/// C90 to the right, C180 and C270 to the left, C0-C180 solid and C90-C270 dashed, rings labelled in round
/// steps of cd (W/sr for radiometric data), flux, peak and beam angles below. Light in one hemisphere only is
/// drawn on a half disc. Throws InputError if the grid breaks its rules. Thread safe; O(gammas).
std::string polar_svg(const IntensityDistribution& distribution, const PolarOptions& options = {});

}  // namespace lucerna
