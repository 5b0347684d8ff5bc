// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Three components in each lane of a vector of doubles, with the operations of Vec3, in their order.
template <class Lanes>
struct LaneVector {
  Lanes x, y, z;

  LaneVector() = default;
  LaneVector(Lanes ax, Lanes ay, Lanes az) : x(ax), y(ay), z(az) {}
  // By components, which stay in registers; as a whole it would be copied through memory.
  LaneVector(const LaneVector& a) : x(a.x), y(a.y), z(a.z) {}
  LaneVector& operator=(const LaneVector& a) {
    x = a.x;
    y = a.y;
    z = a.z;
    return *this;
  }

  friend LaneVector operator+(const LaneVector& a, const LaneVector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend LaneVector operator-(const LaneVector& a, const LaneVector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend LaneVector operator*(Lanes s, const LaneVector& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend LaneVector operator/(const LaneVector& a, Lanes s) { return {a.x / s, a.y / s, a.z / s}; }
  friend Lanes dot(const LaneVector& a, const LaneVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend LaneVector cross(const LaneVector& a, const LaneVector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend LaneVector unit(const LaneVector& a) { return a / sqrt(dot(a, a)); }
  friend LaneVector select(typename Lanes::Mask m, const LaneVector& a, const LaneVector& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
  }

  static LaneVector load(const double* x, const double* y, const double* z) {
    return {Lanes::load(x), Lanes::load(y), Lanes::load(z)};
  }
  void store_to(double* px, double* py, double* pz) const {
    store(px, x);
    store(py, y);
    store(pz, z);
  }
};

}  // namespace lucerna
