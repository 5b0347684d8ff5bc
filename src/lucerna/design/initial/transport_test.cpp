// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Uniform light in a cone about an axis.
std::vector<DirectedFlux> cone(const Vec3& axis, double half_rad, int n) {
  const Frame frame = Frame::from_z(Direction::from(axis));
  std::vector<DirectedFlux> out;
  for (int i = 0; i < n; ++i) {  // a spiral of equal solid angles
    const double z = 1.0 - (1.0 - std::cos(half_rad)) * (i + 0.5) / n, a = 2.399963 * i,
                 s = std::sqrt(1.0 - z * z);
    out.push_back({frame.direction(Direction::from_unit({s * std::cos(a), s * std::sin(a), z})), 1.0 / n});
  }
  return out;
}

TEST(PointTransport, OntoOneDirectionIsAParaboloid) {
  const Direction up = Direction::from({0.1, 0.0, 1.0});
  for (const double sign : {1.0, -1.0}) {
    const PointTransport transport(cone({0, 0, -1}, 1.0, 300), {{up, 1.0}}, sign, 1e-3);
    const Direction axis = Direction::from({0, 0, -1});
    for (const DirectedFlux& l : cone({0, 0, -1}, 1.2, 50)) {
      const double expected = (1.0 - dot(axis, up)) / (1.0 - dot(l.direction, up));
      EXPECT_NEAR(transport.radius(l.direction) / transport.radius(axis), expected, 1e-4);
    }
  }
}

/// Where light from the source along d goes after a mirror of that polar radius, by finite differences.
Vec3 reflected(const PointTransport& transport, const Vec3& d) {
  const Frame f = Frame::from_z(Direction::from(d));
  const auto at = [&](double a, double b) {
    const Direction e = Direction::from(d + a * f.ex() + b * f.ey());
    return transport.radius(e) * e.vec();
  };
  constexpr double kStep = 1e-2;
  const Vec3 n = Direction::from(cross(at(kStep, 0) - at(-kStep, 0), at(0, kStep) - at(0, -kStep)));
  return d - 2.0 * dot(d, n) * n;
}

TEST(PointTransport, SpreadsACircleOfLightEvenlyOverAnother) {
  constexpr double kFrom = 0.9, kTo = 0.35;
  for (const double sign : {1.0, -1.0}) {
    const PointTransport transport(cone({0, 0, -1}, kFrom, 1200), cone({0, 0, 1}, kTo, 1200), sign, 2e-3);
    // Equal shares of light lie within corresponding circles; crossing rays (+1) change sides.
    for (const double share : {0.1, 0.4, 0.7}) {
      const double theta = std::acos(1.0 - share * (1.0 - std::cos(kFrom)));
      const double gamma = std::acos(1.0 - share * (1.0 - std::cos(kTo)));
      const Vec3 out = reflected(transport, {std::sin(theta), 0.0, -std::cos(theta)});
      EXPECT_NEAR(std::acos(out.z / length(out)), gamma, 0.02) << sign << ' ' << share;
      EXPECT_GT(-sign * out.x, 0.0) << sign;
    }
  }
}

TEST(PointTransport, AGuessLeadsToTheSame) {
  const std::vector<DirectedFlux> to = cone({0, 0, 1}, 0.35, 600), from = cone({0, 0, -1}, 0.9, 600);
  for (const double sign : {1.0, -1.0}) {
    const PointTransport other(cone({0, 0, -1}, 0.8, 600), to, sign, 2e-3);
    const PointTransport whole(from, to, sign, 2e-3), guessed(from, to, sign, 2e-3, &other.potentials());
    const Direction axis = Direction::from({0, 0, -1});
    for (const DirectedFlux& l : cone({0, 0, -1}, 0.85, 40)) {
      EXPECT_NEAR(guessed.radius(l.direction) / guessed.radius(axis),
                  whole.radius(l.direction) / whole.radius(axis), 1e-3)
          << sign;
    }
  }
}

TEST(PointTransport, TakesNarrowTargetsAndUnevenLight) {
  std::vector<DirectedFlux> to = cone({0, 0, 1}, 0.02, 400);
  for (std::size_t i = 0; i < to.size(); ++i) to[i].flux *= i % 2 == 0 ? 1.0 : 1e-5;
  const PointTransport transport(cone({0, 0, -1}, 1.2, 800), to, -1.0, 5e-5);
  for (const DirectedFlux& l : cone({0, 0, -1}, 1.0, 40)) {
    EXPECT_TRUE(std::isfinite(transport.radius(l.direction)));
    const Vec3 out = reflected(transport, l.direction);
    EXPECT_LT(std::acos(std::min(1.0, out.z / length(out))), 0.05);
  }
}

}  // namespace
}  // namespace lucerna
