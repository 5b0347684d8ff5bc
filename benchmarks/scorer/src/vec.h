// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace bench {

inline constexpr double kDegree = std::numbers::pi / 180.0;

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// The zero vector stays as it is.
inline Vec3 unit(const Vec3& a) {
  const double l = length(a);
  return l > 0.0 ? (1.0 / l) * a : a;
}

/// A right-handed frame: where its origin and its axes are in the frame of the task.
struct Frame {
  Vec3 origin, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3 vector(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3 point(const Vec3& p) const { return origin + vector(p); }
  Vec3 local_vector(const Vec3& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3 local_point(const Vec3& p) const { return local_vector(p - origin); }
};

/// Any frame whose z axis is `normal`, at the origin.
inline Frame frame_about(const Vec3& normal) {
  Frame f;
  f.z = normal;
  f.x = unit(cross(std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, normal));
  f.y = cross(f.z, f.x);
  return f;
}

}  // namespace bench
