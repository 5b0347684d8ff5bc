// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/view_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

using Colour = std::array<double, 3>;

/// Green's "cubehelix" with its default start, turns and saturation.
Colour heat(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  const double angle = 2.0 * std::numbers::pi * (0.5 / 3.0 + 1.0 - 1.5 * t), reach = 0.5 * t * (1.0 - t);
  const double c = std::cos(angle), s = std::sin(angle);
  return {t + reach * (-0.14861 * c + 1.78277 * s), t + reach * (-0.29227 * c - 0.90649 * s),
          t + reach * 1.97294 * c};
}

/// Blue to white to red for -1 to 1.
Colour signed_colour(double x) {
  const double t = std::clamp(x, -1.0, 1.0);
  return {std::min(1.0, 1.0 + t), 1.0 - std::abs(t), std::min(1.0, 1.0 - t)};
}

}  // namespace

ComparisonPicture comparison_picture(std::size_t columns, std::size_t rows, std::span<const double> reference,
                                     std::span<const double> test, std::size_t zoom) {
  const std::size_t cells = columns * rows;
  LUCERNA_CHECK(cells > 0 && zoom > 0 && reference.size() >= cells && test.size() >= cells,
                "{} x {} cells of {} and {} values", columns, rows, reference.size(), test.size());
  ComparisonPicture p;
  for (std::size_t i = 0; i < cells; ++i) {
    p.white = std::max(p.white, reference[i]);
    p.difference = std::max(p.difference, std::abs(test[i] - reference[i]));
  }
  const auto per = [](double value, double unit) { return unit > 0.0 ? value / unit : 0.0; };
  const std::size_t gap = 8, wide = columns * zoom;
  p.width = 3 * wide + 2 * gap;
  p.height = rows * zoom;
  p.rgb.assign(3 * p.width * p.height, 255);
  for (std::size_t y = 0; y < p.height; ++y) {
    for (std::size_t x = 0; x < wide; ++x) {
      const std::size_t cell = x / zoom * rows + (rows - 1 - y / zoom);
      const std::array<Colour, 3> colours{heat(per(reference[cell], p.white)), heat(per(test[cell], p.white)),
                                          signed_colour(per(test[cell] - reference[cell], p.difference))};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint8_t* pixel = &p.rgb[3 * (y * p.width + k * (wide + gap) + x)];
        for (std::size_t c = 0; c < 3; ++c) {
          pixel[c] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(colours[k][c], 0.0, 1.0)));
        }
      }
    }
  }
  return p;
}

}  // namespace lucerna
