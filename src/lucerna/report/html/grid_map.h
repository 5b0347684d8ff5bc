// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/report/html/html_page.h"

namespace lucerna {

/// Values on an even grid of cells, for a false-colour map.
struct GridMap {
  std::string title, below;
  std::string x_label, y_label;  ///< with their units: "x, mm"
  double x_first = 0.0, x_last = 1.0, y_first = 0.0, y_last = 1.0;
  std::size_t nx = 1, ny = 1;
  std::vector<double> value;           ///< iy * nx + ix, from x_first and y_first on; NaN = nothing there
  std::vector<double> standard_error;  ///< the same, or empty
  std::string unit;                    ///< of the values
  bool true_shape = true;              ///< the same scale along x and y
  double size = 420.0;                 ///< of the longer side, in units of the drawing
  /// Colours of negative and positive values about 0 instead of dark to light.
  bool diverging = false;
  /// Values that the ends of the colours stand for; else the extremes of the values (0 at the lower end if
  /// none is below).
  std::optional<std::pair<double, double>> range{};
};

/// The axes of the map as an SVG document, `data-plot` "grid": assets/plots.js puts the colours and their
/// scale in. Throws std::logic_error if the sizes do not agree. Thread safe.
std::string grid_svg(const GridMap& map);

/// Puts the map's values on the page's list "grids" as float32, unless they are there, and returns their
/// place.
std::size_t add_grid(HtmlPage& page, const GridMap& map);

/// The map as a figure (html_page.h: plot_figure) of what add_grid puts on the page.
std::string grid_figure(HtmlPage& page, const GridMap& map, const std::string& file,
                        const std::string& caption);

}  // namespace lucerna
