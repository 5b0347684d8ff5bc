// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/scene3d.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "lucerna/source/emitter.h"

namespace lucerna {
namespace {

std::vector<float> floats(const std::string& base64) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0;
  int bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    word = word << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255u);
  }
  std::vector<float> out(bytes.size() / 4);
  std::memcpy(out.data(), bytes.data(), 4 * out.size());
  return out;
}

std::vector<float> floats(const nlohmann::ordered_json& value) { return floats(value.get<std::string>()); }

Scene scene_with(const Reflector& mirror) {
  Scene scene;
  PlacedSource source;
  source.rays = make_emitter({.kind = EmitterKind::sphere, .radius_mm = 0.5});
  scene.sources.push_back(source);
  scene.reflectors.push_back(
      {mirror, Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 20}), Reflectance(1.0)});
  scene.far_fields.emplace_back();
  return scene;
}

TEST(Scene3d, MeshLiesOnTheMirrorWithItsSlopeAndCurvature) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0, 10.0))));
  const auto& mirror = json["mirrors"][0];
  const auto position = floats(mirror["position"]), slope = floats(mirror["slope_deg"]),
             curvature = floats(mirror["curvature_per_mm"]);
  const std::size_t n = mirror["rings"].get<std::size_t>() * mirror["spokes"].get<std::size_t>();
  ASSERT_EQ(position.size(), 3 * n);
  ASSERT_EQ(slope.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::hypot(position[3 * i], position[3 * i + 1]);
    EXPECT_GE(r, 5.0 - 1e-4);
    EXPECT_LE(r, 40.0 + 1e-4);
    EXPECT_NEAR(position[3 * i + 2], 20.0 - r * r / 80.0, 1e-4);
    const double p = r / 40.0, w = 1.0 + p * p;
    EXPECT_NEAR(slope[i], degrees(std::atan(p)), 1e-3);
    // Of z = r^2 / 80: along the meridian z'' / w^1.5, across it p / (r sqrt w).
    EXPECT_NEAR(curvature[i], 0.5 * (0.025 / std::pow(w, 1.5) + 0.025 / std::sqrt(w)), 1e-5);
  }
}

TEST(Scene3d, RectanglesKeepTheirCorners) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::rectangle(60.0, 20.0))));
  const auto position = floats(json["mirrors"][0]["position"]);
  int corners = 0;
  for (std::size_t i = 0; i < position.size(); i += 3) {
    EXPECT_LE(std::abs(position[i]), 30.001f);
    EXPECT_LE(std::abs(position[i + 1]), 10.001f);
    if (std::abs(std::abs(position[i]) - 30.0f) < 1e-3f &&
        std::abs(std::abs(position[i + 1]) - 10.0f) < 1e-3f)
      ++corners;
  }
  EXPECT_EQ(corners, 4);
}

TEST(Scene3d, RaysStartAtTheSourceAndCountTheirBounces) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0))), {.rays = 100});
  const auto& rays = json["rays"];
  EXPECT_EQ(rays["count"], 100);
  const auto position = floats(rays["position"]);
  ASSERT_EQ(position.size(), 6 * rays["bounces"].size());
  int starts = 0;
  for (std::size_t i = 0; i < rays["bounces"].size(); ++i) {
    if (rays["bounces"][i] != 0) continue;
    ++starts;
    const float* p = &position[6 * i];
    EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 0.5, 1e-4);
  }
  EXPECT_EQ(starts, 100);
  EXPECT_GT(rays["bounces"].size(), 130u);
}

}  // namespace
}  // namespace lucerna
