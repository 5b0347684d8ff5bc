// SPDX-License-Identifier: Apache-2.0
// Light tables as entries of two-dimensional tasks. Rays are fixed by their seed; bounds are 5 standard
// errors.
#include "light_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support.h"

namespace bench::test {
namespace {

constexpr std::uint64_t kRays = 1 << 19;
using Light = std::function<double(double)>;

/// An LDT file of this symmetry whose planes have the light of an angle from -z, towards +x for 90 degrees to
/// either side of C0.
std::string ldt(int symmetry, int planes, const Light& light, double ratio = 100.0, int gammas = 361) {
  std::string out = "a maker\n0\n" + std::to_string(symmetry) + "\n" + std::to_string(planes) + "\n" +
                    std::to_string(360.0 / planes) + "\n" + std::to_string(gammas) + "\n0.5\n";
  for (int i = 0; i < 5; ++i) out += "text\n";
  for (int i = 0; i < 9; ++i) out += "0\n";
  out += "100\n" + std::to_string(ratio) + "\n1\n0\n1\n1\nlamp\n1000\nwhite\n80\n10\n";
  for (int i = 0; i < 10; ++i) out += "0.5\n";
  for (int k = 0; k < planes; ++k) out += std::to_string(360.0 * k / planes) + "\n";
  for (int i = 0; i < gammas; ++i) out += std::to_string(180.0 * i / (gammas - 1)) + "\n";
  const double first = symmetry == 3 ? 90.0 : 0.0, last = symmetry == 2   ? 180.0
                                                          : symmetry == 3 ? 270.0
                                                          : symmetry == 4 ? 90.0
                                                                          : 359.0;
  for (int k = 0; k < planes; ++k) {
    const double c = 360.0 * k / planes;
    if (symmetry == 1 ? k > 0 : c < first - 1e-9 || c > last + 1e-9) continue;
    const double side = std::cos(c * std::numbers::pi / 180.0) > -1e-9 ? 1.0 : -1.0;
    for (int i = 0; i < gammas; ++i) out += std::to_string(light(side * 180.0 * i / (gammas - 1))) + "\n";
  }
  return out;
}

double cos4(double angle) {
  return std::abs(angle) <= 40.0 ? 1000.0 * std::pow(std::cos(angle * std::numbers::pi / 180.0), 4) : 0.0;
}

Json angle_task() {
  return task_json(
      {{"emitter", "strip"}, {"half_width_mm", 1.0}, {"right_to_left_luminance", 1.0}},
      {{"kind", "angle"}, {"axis", "-z"}, {"function", "cosine_power"}, {"power", 4}, {"edge_deg", 40}});
}

/// Scores a table as a submission of it does.
Scored scored_table(const std::string& text) {
  const TestFolder folder;
  Json entry = submission_json({});
  entry.erase("surfaces");
  entry["light_table"] = "light.ldt";
  folder.write("light.ldt", text);
  const Task task(folder.write("task.json", angle_task()));
  const Submission s(folder.write("submission.json", entry), task);
  const Target target(task.definition.at("target"));
  const SurfaceScene scene(s.parts);
  const Score score = score_of(trace(task, s.source(task), scene, target, {kRays, 7, 2}), target, kRays);
  return {score, score_json(task, s, target, score, {})};
}

TEST(LightTable, OfTheTargetHasItsError) {
  for (const int symmetry : {0, 1, 2, 3, 4}) {
    SCOPED_TRACE(symmetry);
    const Scored found = scored_table(ldt(symmetry, 8, cos4));
    // The edge at 40 degrees is a slope of half a degree in the table.
    EXPECT_LT(found.score.n48.excess, 0.05);
    EXPECT_GT(found.score.efficiency.mean, 0.99);
    EXPECT_TRUE(found.json["counts"].get<bool>());
  }
  const double shifted = scored_table(ldt(0, 8, [](double a) { return cos4(a - 5.0); })).score.n48.excess;
  EXPECT_GT(shifted, 0.15);
}

TEST(LightTable, LightIsDrawnAsTheTableSays) {
  // All the light between 0 and 30 degrees towards +x rises evenly from 0: half of it lies beyond 30 /
  // sqrt(2).
  const TestFolder folder;
  const auto table = read_light_table(folder.write(
      "t.ldt", ldt(
                   0, 4, [](double a) { return a >= 0.0 && a <= 30.0 ? a : 0.0; }, 100.0, 3601)));
  constexpr int kCount = 100000;
  int beyond = 0, other = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    RayRandom random(3, i);
    const SourceRay ray = table->ray(i, random);
    EXPECT_NEAR(length(ray.direction), 1.0, 1e-12);
    const double angle = std::atan2(ray.direction.x, -ray.direction.z) * 180.0 / std::numbers::pi;
    other += angle < 0.0 || angle > 30.06;
    beyond += angle > 30.0 / std::sqrt(2.0);
  }
  EXPECT_EQ(other, 0);
  EXPECT_NEAR(beyond, 0.5 * kCount, 5.0 * std::sqrt(0.25 * kCount));
}

TEST(LightTable, EveryTruncationIsRefused) {
  const TestFolder folder;
  const std::string whole = ldt(4, 4, cos4, 100.0, 19);
  for (std::size_t size = 0; size + 2 < whole.size(); size += 3) {
    // A number that lost its last digits is a number still: cuts end at a line's end or before.
    const std::size_t cut = whole.rfind('\n', size);
    const std::string said = refusal([&] {
      read_light_table(folder.write("t.ldt", whole.substr(0, cut == std::string::npos ? 0 : cut)));
    });
    EXPECT_NE(said.find("t.ldt: line "), std::string::npos) << size << ": " << said;
  }
  EXPECT_EQ(refusal([&] { read_light_table(folder.write("t.ldt", whole)); }), "");
}

TEST(LightTable, WhatIsWrongIsNamed) {
  const TestFolder folder;
  const auto said = [&](const std::string& text) {
    return refusal([&] { read_light_table(folder.write("t.ldt", text)); });
  };
  EXPECT_NE(said(ldt(0, 4, cos4, 92.0)).find("expected 100: the table has all light"), std::string::npos);
  EXPECT_NE(said(ldt(0, 4, [](double) { return 0.0; })).find("t.ldt: intensities: found no light"),
            std::string::npos);
  EXPECT_NE(said(ldt(0, 3, cos4)).find("found no plane C180, expected planes C0 and C180"),
            std::string::npos);
  EXPECT_NE(said(ldt(7, 4, cos4)).find("t.ldt: line 3: found 7, expected a symmetry"), std::string::npos);
  EXPECT_NE(refusal([&] { read_light_table("/none.ldt"); }).find("nothing that can be opened"),
            std::string::npos);
  Json entry = submission_json({});
  entry["light_table"] = "t.ldt";
  const auto refused = [&](const Json& task, const Json& submission) {
    const Task t(folder.write("task.json", task));
    return refusal([&] { Submission(folder.write("submission.json", submission), t); });
  };
  EXPECT_NE(refused(angle_task(), entry).find("expected one of the keys surfaces and light_table"),
            std::string::npos);
  entry.erase("surfaces");
  const Json far = task_json({{"emitter", "disk"}, {"radius_mm", 1.0}},
                             {{"kind", "far_field"}, {"axis", "-z"}, {"function", "wall_washer"}});
  EXPECT_NE(refused(far, entry).find("only two-dimensional tasks take a light table"), std::string::npos);
}

}  // namespace
}  // namespace bench::test
