// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lucerna {

/// A number and its derivative by one parameter: what is computed with it is differentiated on the way.
struct Dual {
  double value = 0.0, slope = 0.0;

  Dual() = default;
  Dual(double v) : value(v) {}  // NOLINT(google-explicit-constructor): constants mix with variables
  Dual(double v, double s) : value(v), slope(s) {}

  friend Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
};

/// sqrt(a^2 + b^2); not both 0.
inline Dual hypotenuse(const Dual& a, const Dual& b) {
  const double length = std::hypot(a.value, b.value);
  return {length, (a.value * a.slope + b.value * b.slope) / length};
}
/// The same of plain numbers.
inline double hypotenuse(double a, double b) { return std::hypot(a, b); }

}  // namespace lucerna
