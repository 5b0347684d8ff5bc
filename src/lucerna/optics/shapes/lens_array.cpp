// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/lens_array.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

ArrayCells::ArrayCells(double pitch_mm, bool is_hexagonal)
    : pitch_mm_(pitch_mm), is_hexagonal_(is_hexagonal) {
  for (int k = 0; k < sides(); ++k) {
    const double a = 2.0 * std::numbers::pi * k / sides();
    neighbours_[static_cast<std::size_t>(k)] = {pitch_mm * std::cos(a), pitch_mm * std::sin(a)};
  }
}

ArrayPoint ArrayCells::centre(double x_mm, double y_mm) const {
  if (!is_hexagonal_)
    return {std::round(x_mm / pitch_mm_) * pitch_mm_, std::round(y_mm / pitch_mm_) * pitch_mm_};
  // The nearest of two rows; every other row is moved by half a pitch.
  const double row_mm = 0.5 * std::numbers::sqrt3 * pitch_mm_, below = std::floor(y_mm / row_mm);
  ArrayPoint best;
  double least = HUGE_VAL;
  for (const double row : {below, below + 1.0}) {
    const double shift = std::fmod(std::abs(row), 2.0) == 1.0 ? 0.5 : 0.0;
    const ArrayPoint c{(std::round(x_mm / pitch_mm_ - shift) + shift) * pitch_mm_, row * row_mm};
    const double square = (x_mm - c.x) * (x_mm - c.x) + (y_mm - c.y) * (y_mm - c.y);
    if (square < least) best = c;
    least = std::min(least, square);
  }
  return best;
}

LensArraySurface::LensArraySurface(const LensArray& array)
    : array_(array), cells_(array.pitch_mm, array.is_hexagonal) {
  const auto [pitch_mm, is_hexagonal, radius_mm, conic, apex_mm] = array;
  if (!(pitch_mm > 0.0 && std::isfinite(pitch_mm)))
    throw InputError(fmt::format("array: pitch_mm is {}, expected a finite number above 0", pitch_mm));
  if (!(std::abs(radius_mm) > 0.0 && std::isfinite(radius_mm)))
    throw InputError(fmt::format("array: radius_mm is {}, expected any finite number but 0", radius_mm));
  if (!(std::isfinite(conic) && std::isfinite(apex_mm)))
    throw InputError(
        fmt::format("array: conic is {} and apex_mm {}, expected finite numbers", conic, apex_mm));
  const double corner = cells_.corner_mm();
  if (!((1.0 + conic) * corner * corner < radius_mm * radius_mm)) {
    throw InputError(fmt::format(
        "array: lenslets of radius_mm = {} and conic = {} end {:.6g} mm from their centres, expected "
        "them to reach the corners of their cells, {:.6g} mm",
        radius_mm, conic, std::abs(radius_mm) / std::sqrt(1.0 + conic), corner));
  }
}

SurfacePoint LensArraySurface::lenslet(double u, double v) const {
  const double c = 1.0 / array_.radius_mm, square = u * u + v * v;
  const double root = std::sqrt(std::max(0.0, 1.0 - (1.0 + array_.conic) * c * c * square));
  return {array_.apex_mm - c * square / (1.0 + root), -c * u / root, -c * v / root};
}

SurfacePoint LensArraySurface::at(double x_mm, double y_mm) const {
  const ArrayPoint centre = cells_.centre(x_mm, y_mm);
  return lenslet(x_mm - centre.x, y_mm - centre.y);
}

HeightRange LensArraySurface::range(const Rectangle&) const {
  const double corner = lenslet(cells_.corner_mm(), 0.0).z_mm;
  return {std::min(corner, array_.apex_mm), std::max(corner, array_.apex_mm)};
}

std::shared_ptr<const HeightSurface> lens_array(const LensArray& array) {
  return std::make_shared<const LensArraySurface>(array);
}

}  // namespace lucerna
