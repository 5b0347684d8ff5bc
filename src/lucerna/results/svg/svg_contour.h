// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/results/svg/svg_canvas.h"

namespace lucerna {

/// A field sampled on a grid of lines x and y of a drawing (in drawing units, each ascending or descending,
/// at least two): `value[iy * x.size() + ix]`, finite.
struct SampledField {
  std::vector<double> x, y;
  std::vector<double> value;
};

/// Where the field is `level`, by marching squares: between neighbouring samples linear; a saddle is decided
/// by the mean of its four corners. Lines that end at the border are open, closed ones repeat their first
/// point. Every crossing of a grid edge is on exactly one line, once. Throws std::logic_error if the sizes do
/// not agree. O(samples). Lorensen and Cline 1987, in the plane.
std::vector<std::vector<SvgPoint>> contour_lines(const SampledField& field, double level);

/// The area where the field is at least `level`, as closed rings for `SvgCanvas::area`; the border closes
/// what reaches it.
std::vector<std::vector<SvgPoint>> contour_rings(const SampledField& field, double level);

/// The line with as few of its points as keep it within `tolerance` of itself (D. Douglas and T. Peucker,
/// Cartographica 10(2), 1973). O(points log points) as a rule.
std::vector<SvgPoint> thinned(const std::vector<SvgPoint>& line, double tolerance = 0.1);

/// The same for every ring of an area.
std::vector<std::vector<SvgPoint>> thinned(std::vector<std::vector<SvgPoint>> rings, double tolerance = 0.1);

/// Numbers on the lines of one drawing that do not touch each other.
class LineLabels {
 public:
  /// Writes `text` on the line, on a white ground, at the share `along` of its length or as near to it as no
  /// other label is in the way; nothing if there is no such place, or if the line is shorter than
  /// `min_length`.
  void write(SvgCanvas& canvas, const std::vector<SvgPoint>& line, const std::string& text,
             double along = 0.5, double min_length = 60.0);

 private:
  struct Box {
    SvgPoint centre;
    double width, height;
  };
  std::vector<Box> taken_;
};

}  // namespace lucerna
