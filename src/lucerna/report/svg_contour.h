// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/report/svg_canvas.h"

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

/// Writes `text` on the line, on a white ground, at the share `along` of its length; nothing if the line is
/// shorter than `least_length`.
void label_line(SvgCanvas& canvas, const std::vector<SvgPoint>& line, const std::string& text,
                double along = 0.5, double least_length = 60.0);

}  // namespace lucerna
