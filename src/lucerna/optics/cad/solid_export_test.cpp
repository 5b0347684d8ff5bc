// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/error.h"
#include "tests/support/random_rays.h"
#include "tests/support/spline_face.h"

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

void expect_closed_shell(const std::string& text, long euler) {
  EXPECT_EQ(count_of(text, "CLOSED_SHELL("), 1u);
  EXPECT_EQ(count_of(text, "MANIFOLD_SOLID_BREP("), 1u);
  const auto vertices = static_cast<long>(count_of(text, "VERTEX_POINT("));
  const auto edges = static_cast<long>(count_of(text, "EDGE_CURVE("));
  const auto faces = static_cast<long>(count_of(text, "ADVANCED_FACE("));
  EXPECT_EQ(vertices - edges + faces, euler);
  // Every edge bounds two faces.
  EXPECT_EQ(static_cast<long>(count_of(text, "ORIENTED_EDGE(")), 2 * edges);
}

// Euler: vertices - edges + faces is 2 for a body without a hole, 0 for a ring.
TEST(SolidExport, StepIsAClosedShell) {
  for (const auto& [outline, euler] : {std::pair(kLens, 2L), {kRing, 0L}}) {
    const std::string text = solid_step_text(outline, 30.0);
    expect_closed_shell(text, euler);
  }
}

/// How often each edge is used along its way and against it.
std::map<std::string, std::array<int, 2>> uses_of_edges(const std::string& text) {
  static const std::regex kUse("ORIENTED_EDGE\\('[^']*',\\*,\\*,(#[0-9]+),\\.([TF])\\.\\)");
  std::map<std::string, std::array<int, 2>> out;
  for (std::sregex_iterator i(text.begin(), text.end(), kUse), end; i != end; ++i)
    ++out[(*i)[1]][(*i)[2] == "T" ? 0 : 1];
  return out;
}

// A flat base, and a dome cavity: base and wall in halves, the face in one piece.
TEST(SolidExport, StepOfAFreeFaceIsAClosedShell) {
  const auto face = test::spline_face(
      [](double x, double y) { return 8.0 + 0.01 * x * x - 0.012 * y * y + 0.001 * x * y * y; }, 11.0, 6);
  for (const auto& [outline, faces] : {std::pair(Outline{{0, 0}, {10, 0}, {10, 3}}, 5u),
                                       {Outline{{0, 3}, {2, 2}, {3, 0}, {10, 0}, {10, 3}}, 9u}}) {
    const std::string text = solid_step_text(outline, {*face}, 15.0);
    expect_closed_shell(text, 2);
    EXPECT_EQ(count_of(text, "ADVANCED_FACE("), faces);
    EXPECT_EQ(count_of(text, "B_SPLINE_SURFACE_WITH_KNOTS("), 1u);
    const auto uses = uses_of_edges(text);
    EXPECT_EQ(uses.size(), count_of(text, "EDGE_CURVE("));
    for (const auto& [edge, both] : uses) EXPECT_EQ(both, (std::array<int, 2>{1, 1})) << edge;
    EXPECT_EQ(text, solid_step_text(outline, {*face}, 15.0));
  }
}

// A free form at the bottom too: two walls in halves, the flange between them, two splines.
TEST(SolidExport, StepOfTwoFreeFacesIsAClosedShell) {
  const auto top =
      test::spline_face([](double x, double y) { return 8.0 + 0.01 * x * x - 0.012 * y * y; }, 11.0, 6);
  const auto bottom = test::spline_face([](double x, double y) { return 2.0 - 0.02 * x * y; }, 7.0, 4);
  const Outline outline{{6, 1}, {6, 0}, {10, 0}, {10, 3}};
  const std::string text = solid_step_text(outline, {*top, bottom.get()}, 15.0);
  expect_closed_shell(text, 2);
  EXPECT_EQ(count_of(text, "ADVANCED_FACE("), 8u);
  EXPECT_EQ(count_of(text, "B_SPLINE_SURFACE_WITH_KNOTS("), 2u);
  for (const auto& [edge, both] : uses_of_edges(text)) EXPECT_EQ(both, (std::array<int, 2>{1, 1})) << edge;
}

TEST(SolidExport, AFaceIsABspline) {
  const Outline outline{{0, -1}, {10, -1}, {10, 0}};
  const Reflector bowl = conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(20.0));
  EXPECT_EQ(test::message_of<InputError>(
                [&] { static_cast<void>(solid_step_text(outline, {*bowl.surface}, 15.0)); }),
            "CAD: STEP: found a face of a solid that is no B-spline, expected one with coefficients");
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
