// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/error.h"

namespace lucerna {
namespace {

using Outline = std::vector<std::array<double, 2>>;

const Outline kLens{{0, 3}, {9, 3}, {9, 5}, {6, 7.6}, {3, 9.1}, {0, 9.6}};
const Outline kRing{{5, 0}, {8, 0}, {8, 4}, {5, 4}};

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

// Euler: vertices - edges + faces is 2 for a body without a hole, 0 for a ring.
TEST(SolidExport, StepIsAClosedShell) {
  for (const auto& [outline, euler] : {std::pair(kLens, 2L), {kRing, 0L}}) {
    const std::string text = solid_step_text(outline, 30.0);
    EXPECT_EQ(count_of(text, "CLOSED_SHELL("), 1u);
    EXPECT_EQ(count_of(text, "MANIFOLD_SOLID_BREP("), 1u);
    const auto vertices = static_cast<long>(count_of(text, "VERTEX_POINT("));
    const auto edges = static_cast<long>(count_of(text, "EDGE_CURVE("));
    const auto faces = static_cast<long>(count_of(text, "ADVANCED_FACE("));
    EXPECT_EQ(vertices - edges + faces, euler);
    // Every edge bounds two faces.
    EXPECT_EQ(static_cast<long>(count_of(text, "ORIENTED_EDGE(")), 2 * edges);
  }
}

TEST(SolidExport, ProfileIsClosedAndHasTheVolume) {
  const auto profile = solid_profile(kRing, 30.0);
  ASSERT_EQ(profile.front(), profile.back());
  double volume = 0.0;  // of the body that the profile turns, by Green's theorem
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto &a = profile[i], &b = profile[i + 1];
    volume += std::numbers::pi / 3.0 * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) * (b[1] - a[1]);
  }
  EXPECT_NEAR(volume, std::numbers::pi * (64.0 - 25.0) * 4.0, 1e-9);
}

TEST(SolidExport, RefusesWhatHasNoEdge) {
  Outline round;
  for (int i = 0; i < 40; ++i) round.push_back({10.0 + 3.0 * std::cos(0.157 * i), 3.0 * std::sin(0.157 * i)});
  EXPECT_THROW(static_cast<void>(solid_step_text(round, 30.0)), InputError);
}

}  // namespace
}  // namespace lucerna
