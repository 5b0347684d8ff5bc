// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "lucerna/cli/output/compare_parts.h"

namespace lucerna::cli {
namespace {

using testing::HasSubstr;

/// A comparison of which every number is another one.
RayFileComparison compared() {
  RayFileComparison r;
  r.reference_rays = 1000, r.test_rays = 2000;
  double next = 0.01;
  for (const ViewKind kind : kViewKinds) r.views[kind] = {next += 0.01, 0.001, 0.002, 0.003, 0.004};
  r.focus_plane = {{12.0, 0.25, 0.2}, {240.0, 0.05, 0.04}};
  r.fields.near = CrossCorrelation{0.99, 0.995};
  r.reference_etendue = {1.0, 2.0, 3.0};
  r.test_etendue = {4.0, 5.0, std::nan("")};
  return r;
}

std::string said(const RayFileComparison& r) {
  Session session;
  session.start();
  CompareArguments a;
  a.reference = "a.ray", a.test = "b.nfl";
  testing::internal::CaptureStdout();
  say_rays(a, r, session);
  return testing::internal::GetCapturedStdout();
}

TEST(CompareRaysOutput, HasEveryNumberUnderItsKey) {
  const Json json = rays_json(compared());
  EXPECT_EQ(json["rays"], Json({1000, 2000}));
  EXPECT_DOUBLE_EQ(json["views"]["far"]["error"].get<double>(), 0.02);
  EXPECT_DOUBLE_EQ(json["views"]["four_d"]["error"].get<double>(), 0.06);
  EXPECT_EQ(json["focus_plane"][1]["cell_um"], 240.0);
  EXPECT_EQ(json["focus_plane"][1]["l1"], 0.05);
  EXPECT_EQ(json["cross_correlation"]["near"]["noise_limit"], 0.995);
  EXPECT_EQ(json["etendue_mm2sr"]["reference"]["p90"], 2.0);
}

TEST(CompareRaysOutput, WhatIsNotThereIsNull) {
  const Json json = rays_json(compared());
  EXPECT_TRUE(json["cross_correlation"]["far"].is_null());
  EXPECT_TRUE(json["etendue_mm2sr"]["test"]["p99"].is_null());
  EXPECT_FALSE(json.contains("pictures"));
  RayFileComparison with = compared();
  with.pictures.push_back({"far.png", 3.0, 0.5, 0.1});
  EXPECT_EQ(rays_json(with)["pictures"][0]["half_width_mm"], 3.0);
}

TEST(CompareRaysOutput, LinesAreForPeople) {
  const std::string text = said(compared());
  EXPECT_THAT(text, HasSubstr("b.nfl (2000 rays) against a.ray (1000 rays)"));
  EXPECT_THAT(text, HasSubstr("  far          2.000     0.100     0.200     0.300     0.400\n"));
  EXPECT_THAT(text, HasSubstr("      12 um    0.2500 (0.2000)\n"));
  EXPECT_THAT(text, HasSubstr("  near       0.99000 (0.99500)\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("  mid ")));
}

TEST(CompareRaysOutput, HeldOutRaysHaveViewsAndScales) {
  HeldOutComparison h;
  h.training_rays = 500, h.held_out_rays = 501;
  h.views[ViewKind::beam] = {0.5, 0.4, 0.3, 0.2, 0.1};
  h.scales[0] = {0.0125, {0.07, 0.06, 0.05, 0.04, 0.03}};
  Session session;
  session.start();
  testing::internal::CaptureStdout();
  print_held_out(h, session);
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_THAT(text, HasSubstr("a model of 500 rays against 501 others"));
  EXPECT_THAT(text, HasSubstr("  beam        50.000    40.000    30.000    20.000    10.000\n"));
  EXPECT_THAT(text, HasSubstr("0.0125 mm"));
}

}  // namespace
}  // namespace lucerna::cli
