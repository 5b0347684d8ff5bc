// SPDX-License-Identifier: Apache-2.0
// Light tables as entries of two-dimensional tasks. Rays are fixed by their seed; bounds are 5 standard
// errors.
#include "light_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "support.h"

namespace bench::test {
namespace {

constexpr std::uint64_t kRays = 1 << 19;
/// Intensity in a C plane, degrees, at a gamma.
using Light = std::function<double(double c, double gamma)>;

/// The planes that a file of a symmetry stores.
std::vector<double> stored(int symmetry, int planes) {
  const double step = 360.0 / planes;
  const double first = symmetry == 3 ? 270.0 : 0.0;
  const int count = symmetry == 1   ? 1
                    : symmetry == 4 ? planes / 4 + 1
                    : symmetry == 0 ? planes
                                    : planes / 2 + 1;
  std::vector<double> out;
  for (int k = 0; k < count; ++k) out.push_back(std::fmod(first + k * step, 360.0));
  return out;
}

std::string ldt(int symmetry, int planes, const Light& light, const std::string& ratio = "100",
                int gammas = 361, double first_gamma = 0.0) {
  std::string out = "a maker\n0\n" + std::to_string(symmetry) + "\n" + std::to_string(planes) + "\n" +
                    std::to_string(360.0 / planes) + "\n" + std::to_string(gammas) + "\n0.5\n";
  for (int i = 0; i < 5; ++i) out += "text\n";
  for (int i = 0; i < 9; ++i) out += "0\n";
  out += "100\n" + ratio + "\n1\n0\n1\n1\nlamp\n1000\nwhite\n80\n10\n";
  for (int i = 0; i < 10; ++i) out += "0.5\n";
  for (int k = 0; k < planes; ++k) out += std::to_string(360.0 * k / planes) + "\n";
  const auto gamma = [&](int i) { return first_gamma + (180.0 - first_gamma) * i / (gammas - 1); };
  for (int i = 0; i < gammas; ++i) out += std::to_string(gamma(i)) + "\n";
  for (const double c : stored(symmetry, planes)) {
    for (int i = 0; i < gammas; ++i) out += std::to_string(light(c, gamma(i))) + "\n";
  }
  return out;
}

/// Light of an angle from -z, towards +x where it is positive; other planes have light that does not belong
/// here. What is stored once for both halves is that of +x.
Light in_plane(const std::function<double(double)>& f) {
  return [f](double c, double gamma) {
    return c == 0.0 ? f(gamma) : c == 180.0 ? f(-gamma) : 5000.0 + gamma;
  };
}

double cos4(double angle) {
  return std::abs(angle) <= 40.0 ? 1000.0 * std::pow(std::cos(angle * std::numbers::pi / 180.0), 4) : 0.0;
}

Json angle_task() {
  return task_json(
      {{"emitter", "strip"}, {"half_width_mm", 1.0}, {"right_to_left_luminance", 1.0}},
      {{"kind", "angle"}, {"axis", "-z"}, {"function", "cosine_power"}, {"power", 4}, {"edge_deg", 40}});
}

Json table_entry() {
  Json entry = submission_json({});
  entry.erase("surfaces");
  entry["light_table"] = "light.ldt";
  return entry;
}

Scored scored_table(const std::string& text) {
  return scored(angle_task(), table_entry(), kRays, 2, {{"light.ldt", text}});
}

TEST(LightTable, OfTheTargetHasItsError) {
  for (const int symmetry : {0, 1, 2, 3, 4}) {
    SCOPED_TRACE(symmetry);
    const Scored found = scored_table(ldt(symmetry, 8, in_plane(cos4)));
    // The edge at 40 degrees is a slope of half a degree in the table.
    EXPECT_LT(found.score.n48.excess, 0.01 + 5.0 * found.score.n48.standard_error);
    EXPECT_GT(found.score.efficiency.mean, 0.99);
    EXPECT_TRUE(found.json["counts"].get<bool>());
    EXPECT_TRUE(found.json["light_table"].get<bool>());
  }
  const auto moved = [](double a) { return cos4(a - 5.0); };
  EXPECT_GT(scored_table(ldt(0, 8, in_plane(moved))).score.n48.excess, 0.15);
}

/// Shares of the light of a table towards +x, and beyond an angle.
std::array<double, 2> shares(const std::string& text, double angle_deg) {
  const TestFolder folder;
  const auto table = read_light_table(folder.write("t.ldt", text));
  constexpr int kCount = 100000;
  std::array<double, 2> found{};
  for (std::uint64_t i = 0; i < kCount; ++i) {
    RayRandom random(3, i);
    const SourceRay ray = table->ray(i, random);
    EXPECT_NEAR(length(ray.direction), 1.0, 1e-12);
    const double angle = std::atan2(ray.direction.x, -ray.direction.z) * 180.0 / std::numbers::pi;
    found[0] += (angle > 0.0) / static_cast<double>(kCount);
    found[1] += (std::abs(angle) > angle_deg) / static_cast<double>(kCount);
  }
  return found;
}

TEST(LightTable, LightIsDrawnAsTheTableSays) {
  // It rises evenly from 0 to 30 degrees, three times as high towards +x: half of it lies beyond 30 /
  // sqrt(2).
  const auto light = in_plane([](double a) { return std::abs(a) <= 30.0 ? (a > 0.0 ? 3.0 * a : -a) : 0.0; });
  constexpr double kFive = 5.0 * 0.5 / 316.0;
  for (const int symmetry : {0, 2}) {
    const auto found = shares(ldt(symmetry, 4, light, "100", 3601), 30.0 / std::sqrt(2.0));
    EXPECT_NEAR(found[0], 0.75, kFive);
    EXPECT_NEAR(found[1], 0.5, kFive);
  }
  for (const int symmetry : {1, 3, 4}) {
    const auto found = shares(ldt(symmetry, 4, light, "100", 3601), 30.0 / std::sqrt(2.0));
    EXPECT_NEAR(found[0], 0.5, kFive);
    EXPECT_NEAR(found[1], 0.5, kFive);
  }
  // Small numbers are light too.
  std::string faint = ldt(0, 4, in_plane([](double a) { return std::abs(a) <= 90.0 ? 7.25 : 0.0; }));
  for (std::size_t at = 0; (at = faint.find("7.250000\n", at)) != std::string::npos;)
    faint.replace(at, 8, "1e-90");
  EXPECT_NEAR(shares(faint, 45.0)[1], 0.5, kFive);
}

TEST(LightTable, EveryTruncationIsRefused) {
  const TestFolder folder;
  const std::string whole = ldt(4, 4, in_plane(cos4), "100", 19);
  for (std::size_t size = 0; size + 2 < whole.size(); size += 3) {
    // A number that lost its last digits is a number still: cuts end at a line's end or before.
    const std::size_t cut = whole.rfind('\n', size);
    const std::string said = refusal([&] {
      read_light_table(folder.write("t.ldt", whole.substr(0, cut == std::string::npos ? 0 : cut)));
    });
    EXPECT_NE(said.find("t.ldt: line "), std::string::npos) << size << ": " << said;
  }
  EXPECT_EQ(refusal([&] { read_light_table(folder.write("t.ldt", whole + "\r\n\x1a")); }), "");
}

TEST(LightTable, WhatIsWrongIsNamed) {
  const TestFolder folder;
  const auto said = [&](const std::string& text) {
    return refusal([&] { read_light_table(folder.write("t.ldt", text)); });
  };
  const auto expect = [&](const std::string& text, const std::string& message) {
    const std::string found = said(text);
    EXPECT_NE(found.find(message), std::string::npos) << found;
  };
  const Light good = in_plane(cos4);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = ldt(2, 4, good);
    return text.replace(text.find(from), from.size(), to);
  };
  expect(ldt(0, 4, good, "92"), "line 23: found 92, expected 100: the table has all light");
  expect(ldt(0, 4, good, "99.98"), "found 99.98, expected 100");
  EXPECT_EQ(said(ldt(0, 4, good, "100.001")), "");
  expect(ldt(0, 4, [](double, double) { return 0.0; }), "t.ldt: intensities: found no light in C0 and C180");
  expect(ldt(0, 4, good, "100", 19, 10.0), "t.ldt: gammas: found 10 as the first, expected 0");
  expect(ldt(7, 4, good), "t.ldt: line 3: found 7, expected a symmetry");
  expect(ldt(0, 4, good) + "1\n", "found more lines, expected the end of the file");
  for (const auto& [symmetry, planes] : {std::pair{0, 3}, {2, 5}, {3, 2}, {3, 6}, {4, 6}})
    expect(ldt(symmetry, planes, good),
           "t.ldt: C planes: found " + std::to_string(planes) + " planes that do not lie");
  // Plane C180 is the fourth: of this symmetry three are stored.
  expect(with("90.000000\n180.000000\n270.000000\n", "45.000000\n90.000000\n180.000000\n"),
         "t.ldt: C planes: found 4");
  expect(with("1000.000000", "-1"), "found -1, expected an intensity");
  expect(with("1000.000000", "nan"), "found nan, expected an intensity");
  expect(with("1000.000000", "1000,5"), "found 1000,5, expected an intensity");
  EXPECT_EQ(said(with("1000.000000\n", "1000.000000\r\n")), "");
  EXPECT_NE(refusal([&] { read_light_table("/none.ldt"); }).find("nothing that can be opened"),
            std::string::npos);
}

TEST(LightTable, OnlyTasksOfTwoDimensionsTakeOne) {
  const TestFolder folder;
  folder.write("light.ldt", ldt(0, 4, in_plane(cos4)));
  Json entry = table_entry();
  const auto refused = [&](const Json& task, const Json& submission) {
    const Task t(folder.write("task.json", task));
    return refusal([&] { Submission(folder.write("submission.json", submission), t); });
  };
  EXPECT_EQ(refused(angle_task(), entry), "");
  const Json far = task_json({{"emitter", "disk"}, {"radius_mm", 1.0}},
                             {{"kind", "far_field"}, {"axis", "-z"}, {"function", "wall_washer"}});
  EXPECT_NE(refused(far, entry).find("only two-dimensional tasks take a light table"), std::string::npos);
  // Neither ways out of the folder nor links that lead there.
  const TestFolder other;
  std::filesystem::create_symlink(other.write("t.ldt", ldt(0, 4, in_plane(cos4))),
                                  folder.path() / "link.ldt");
  for (const char* name : {"../t.ldt", "link.ldt", "/etc/passwd", ""}) {
    entry["light_table"] = name;
    EXPECT_NE(refused(angle_task(), entry).find("expected a file in the folder of the submission"),
              std::string::npos)
        << name;
  }
  entry["light_table"] = ".";
  EXPECT_NE(refused(angle_task(), entry).find("found a folder or a device"), std::string::npos);
  entry["light_table"] = "light.ldt";
  entry["surfaces"] = Json::array();
  EXPECT_NE(refused(angle_task(), entry).find("found both of surfaces and light_table"), std::string::npos);
  entry.erase("surfaces");
  entry.erase("light_table");
  EXPECT_NE(refused(angle_task(), entry).find("found neither surfaces nor light_table"), std::string::npos);
}

}  // namespace
}  // namespace bench::test
