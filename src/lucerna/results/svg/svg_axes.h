// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lucerna/intensity.h"
#include "lucerna/results/svg/svg_canvas.h"

namespace lucerna {

/// Figures that are written into a diagram as they were estimated; without them those of the grid's values
/// are, which is right where the values have no noise.
struct DrawnFigures {
  std::string peak;     ///< "Flux 920 lm · peak 1759 ± 4 cd at C 12°, γ 30°"
  std::string c0, c90;  ///< "beam 50 % 62.9 ± 0.3°, field 10 % 86.6 ± 0.4°" of C0-C180 and C90-C270
};

/// What every diagram of a distribution can be told.
struct DiagramOptions {
  std::string title{};                   ///< above the diagram; UTF-8; empty = the diagram's own name
  std::optional<double> lamp_flux_lm{};  ///< if given, intensities are in cd/klm of this flux instead of cd
  /// Standard errors of the values (layout of `cd`): their 95 % intervals are drawn as a band. Not owned.
  std::span<const double> standard_error{};
  std::optional<DrawnFigures> figures{};
};

/// The values moved by `errors` standard errors, none below 0: one edge of a band.
IntensityDistribution moved_by_errors(const IntensityDistribution& distribution,
                                      std::span<const double> standard_error, double errors);

/// The unit that intensities are shown in.
struct ShownIntensity {
  double per_cd = 1.0;
  std::string name;  ///< "cd", "cd/klm" or "W/sr"
};
ShownIntensity shown_intensity(const IntensityDistribution& distribution,
                               const std::optional<double>& lamp_flux_lm);

/// One direction of a plot: values first to last lie at at_first to at_last of the drawing, in even or
/// (`log`, both values above 0) logarithmic steps.
struct PlotAxis {
  double first = 0.0, last = 1.0, at_first = 0.0, at_last = 1.0;
  bool log = false;

  /// Place of a value in the drawing; on a logarithmic axis values below `first` lie at `first`.
  double at(double value) const;
  /// The text of `SvgCanvas::data` for this axis.
  std::string data() const;
};

/// Round values within [first, last] in about `wanted` steps; powers of ten for a logarithmic axis.
std::vector<double> ticks(const PlotAxis& axis, int wanted);

/// Steps that divide an angular range: 2 to 30 degrees, about 12 from one end to the other at most.
std::vector<double> angle_ticks(double first_deg, double last_deg);

/// "37.5°", or a dash where there is none.
std::string degrees_text(const std::optional<double>& angle_deg);

/// Grid lines, frame and numbers (each with `suffix`) of a plot; y numbers to the left, x numbers below.
void draw_grid(SvgCanvas& canvas, const PlotAxis& x, const std::vector<double>& x_ticks,
               const std::string& x_suffix, const PlotAxis& y, const std::vector<double>& y_ticks,
               const std::string& y_suffix);

/// Title (bold) and a line below it, centred at the top; uses 56 units of height.
void draw_title(SvgCanvas& canvas, const std::string& title, const std::string& below);

/// The colour of a share of [0, 1]: viridis, dark to light (van der Walt and Smith 2015), which also reads in
/// grey. As #rrggbb.
std::string viridis(double share);
/// The same as red, green, blue of 0 to 255.
std::array<int, 3> viridis_rgb(double share);

/// Shares of the peak that bands of false colour and isocandela lines are drawn at, descending.
inline constexpr double kPeakShares[] = {0.9, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01};

/// The smallest of `ranges_deg` (ascending) within which, as angle from the axis, lies every grid direction
/// with at least `share` of the largest intensity in the last range; the last range if no smaller one does.
double range_holding(const IntensityDistribution& distribution, double axis_gamma_deg, double share,
                     const std::vector<double>& ranges_deg);

/// Throws InputError "NAME: fault" if the distribution's grid breaks its rules.
void check_drawable(const IntensityDistribution& distribution, const char* name);

}  // namespace lucerna
