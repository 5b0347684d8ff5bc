// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// A point of a drawing: user units (1 unit = 1 CSS pixel), x to the right, y down.
struct SvgPoint {
  double x = 0.0, y = 0.0;
};

/// How a line or area is drawn. Colours are any SVG colour; an empty fill or stroke is "none".
struct SvgStyle {
  std::string stroke{};
  double width = 1.0;
  std::string dash{};  ///< SVG dash pattern, e.g. "8 5"; empty = solid
  std::string fill{};
  double opacity = 1.0;
};

/// How text is set. `anchor`: start, middle or end.
struct SvgText {
  double size = 13.0;
  std::string anchor = "start";
  std::string fill = "#222";
  bool bold = false;
  double turn_deg = 0.0;  ///< about the point, clockwise
};

/// An SVG picture on a white ground, built element by element in drawing order. Text is escaped.
/// Self-contained: no script, no outside reference. Not thread safe.
class SvgCanvas {
 public:
  SvgCanvas(double width, double height);

  void line(SvgPoint a, SvgPoint b, const SvgStyle& style);
  void polyline(const std::vector<SvgPoint>& points, const SvgStyle& style, bool closed = false);
  /// The area inside an odd number of the closed rings: rings in rings are holes.
  void area(const std::vector<std::vector<SvgPoint>>& rings, const SvgStyle& style);
  void circle(SvgPoint centre, double radius, const SvgStyle& style);
  void rectangle(SvgPoint corner, double width, double height, const SvgStyle& style);
  /// `text` is UTF-8; `y` of the point is the base line.
  void text(SvgPoint at, std::string_view text, const SvgText& style = {});
  /// Everything until `end_clip` shows only inside the rectangle.
  void begin_clip(SvgPoint corner, double width, double height);
  void end_clip();

  /// Adds data-NAME="value" to the document's root: how the page's script finds the value under the cursor.
  /// Diagrams set `plot` (their kind), and either polar ("cx cy units-per-intensity") or x and y ("first last
  /// value-at-first value-at-last", in units of the drawing; append " log" for a logarithmic axis).
  void data(std::string_view name, std::string_view value);

  double width() const { return width_; }
  double height() const { return height_; }

  /// The whole document.
  std::string str() const;

 private:
  double width_, height_;
  int clips_ = 0;
  std::string body_, data_;
};

/// A round step (1, 2, 2.5 or 5 times a power of ten) that divides [0, `maximum`] into `wanted` parts or a
/// few less.
double nice_step(double maximum, int wanted);

/// A number for a label: at most 4 significant digits, no exponent between 0.001 and 10^7.
std::string label_number(double value);

/// The colours of the curves, dark enough for print and apart for the colour blind (Okabe and Ito 2008).
inline constexpr std::string_view kCurveColors[] = {"#0072b2", "#d55e00", "#009e73",
                                                    "#cc79a7", "#e69f00", "#56b4e9"};

}  // namespace lucerna
