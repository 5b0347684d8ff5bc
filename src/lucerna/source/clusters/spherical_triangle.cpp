// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/spherical_triangle.h"

#include <cmath>
#include <vector>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

Vec3 unit(const Vec3& v) { return v / length(v); }

struct Midpoints {
  Vec3 ab, bc, ca;
};

Midpoints midpoints(const SphericalTriangle& t) {
  return {unit(t.a + t.b), unit(t.b + t.c), unit(t.c + t.a)};
}

SphericalTriangle child(const SphericalTriangle& t, const Midpoints& m, std::uint32_t which) {
  switch (which) {
    case 0:
      return {t.a, m.ab, m.ca};
    case 1:
      return {m.ab, t.b, m.bc};
    case 2:
      return {m.ca, m.bc, t.c};
    default:
      return {m.bc, m.ca, m.ab};
  }
}

constexpr SphericalTriangle kFirstOctant{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Angle between the planes (a, b) and (a, c) at a.
double corner_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = cross(a, b), ac = cross(a, c);
  return std::atan2(length(cross(ab, ac)), dot(ab, ac));
}

/// `v` without its part along the unit vector `axis`, as a unit vector.
Vec3 across(const Vec3& v, const Vec3& axis) { return unit(v - dot(v, axis) * axis); }

}  // namespace

double SphericalTriangle::solid_angle_sr() const {
  return 2.0 * std::atan2(std::abs(dot(a, cross(b, c))), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
}

SphericalTriangleSampler::SphericalTriangleSampler(const SphericalTriangle& t)
    : a_(t.a),
      b_(t.b),
      c_across_a_(across(t.c, t.a)),
      solid_angle_(t.solid_angle_sr()),
      alpha_(corner_angle(t.a, t.b, t.c)),
      sin_alpha_(std::sin(alpha_)),
      cos_alpha_(std::cos(alpha_)),
      cos_side_(dot(t.a, t.b)) {}

std::uint32_t direction_code(const Direction& d) {
  std::uint32_t code = (d.x() < 0.0 ? 1u : 0u) | (d.y() < 0.0 ? 2u : 0u) | (d.z() < 0.0 ? 4u : 0u);
  const Vec3 p{std::abs(d.x()), std::abs(d.y()), std::abs(d.z())};
  SphericalTriangle t = kFirstOctant;
  for (int level = 0; level < kDirectionDepth; ++level) {
    const Midpoints m = midpoints(t);
    std::uint32_t which = 3;
    if (dot(cross(m.ab, m.ca), p) > 0.0) {
      which = 0;
    } else if (dot(cross(m.bc, m.ab), p) > 0.0) {
      which = 1;
    } else if (dot(cross(m.ca, m.bc), p) > 0.0) {
      which = 2;
    }
    code = code << 2 | which;
    t = child(t, m, which);
  }
  return code;
}

SphericalTriangle direction_triangle(std::uint32_t code, int depth) {
  LUCERNA_CHECK(code < kDirectionCodes && depth >= 0 && depth <= kDirectionDepth, "code {}, depth {}", code,
                depth);
  SphericalTriangle t = kFirstOctant;
  for (int level = 0; level < depth; ++level) {
    t = child(t, midpoints(t), code >> (2 * (kDirectionDepth - 1 - level)) & 3u);
  }
  const std::uint32_t octant = code >> (2 * kDirectionDepth);
  const double x = octant & 1u ? -1.0 : 1.0, y = octant & 2u ? -1.0 : 1.0, z = octant & 4u ? -1.0 : 1.0;
  for (Vec3* v : {&t.a, &t.b, &t.c}) *v = {x * v->x, y * v->y, z * v->z};
  return t;
}

const std::array<double, 4>& direction_child_shares(std::uint32_t code, int depth) {
  constexpr int kTabled = 6;
  static const auto tables = [] {
    std::array<std::vector<std::array<double, 4>>, kTabled> result;
    for (int level = 0; level < kTabled; ++level) {
      result[static_cast<std::size_t>(level)].resize(std::size_t{1} << (2 * level));
      for (std::uint32_t i = 0; i < 1u << (2 * level); ++i) {
        const SphericalTriangle t = direction_triangle(i << (2 * (kDirectionDepth - level)), level);
        const Midpoints m = midpoints(t);
        for (std::uint32_t k = 0; k < 4; ++k) {
          result[static_cast<std::size_t>(level)][i][k] =
              child(t, m, k).solid_angle_sr() / t.solid_angle_sr();
        }
      }
    }
    return result;
  }();
  static constexpr std::array<double, 4> kQuarters{0.25, 0.25, 0.25, 0.25};
  if (depth >= kTabled) return kQuarters;
  const std::uint32_t within = code & ((1u << (2 * kDirectionDepth)) - 1u);
  return tables[static_cast<std::size_t>(depth)][within >> (2 * (kDirectionDepth - depth))];
}

}  // namespace lucerna
