// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// One line of a diagram. Places where x or y is not finite (on a logarithmic axis: not above 0) are left
/// out.
struct Curve {
  std::string name;
  std::vector<double> x, y;  ///< of the same length; x ascending for values under the cursor
  bool dashed = false;
  bool dots = false;  ///< dots at the points instead of a line
};

struct CurveAxis {
  std::string label;  ///< below or beside the axis: "flux, %"
  bool log = false;
  std::optional<double> first{}, last{};  ///< else what the curves need; linear axes then begin at 0
};

struct CurvePlot {
  std::string title, below;
  CurveAxis x, y;
  std::vector<Curve> curves;
};

/// A diagram of lines as an SVG document, with a legend; at most as many curves as there are `kCurveColors`
/// are distinguished. Throws InputError if nothing can be drawn. Thread safe; O(points).
std::string curves_svg(const CurvePlot& plot);

/// The same numbers for the page's script: `data-plot` "curves" (assets/report.js) and the saved table.
nlohmann::ordered_json curves_json(const CurvePlot& plot);

}  // namespace lucerna
