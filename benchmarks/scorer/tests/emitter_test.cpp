// SPDX-License-Identifier: Apache-2.0
#include "emitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support.h"

namespace bench::test {
namespace {

std::unique_ptr<Source> emitter(Json source) {
  source["place"] = place(0.0);
  return read_emitter(JsonNode("task.json", source));
}

struct Mean {
  double value, error;
};
/// Of a function of 1e5 rays, with its standard error.
Mean mean(const Source& source, const std::function<double(const SourceRay&)>& f) {
  constexpr int n = 100'000;
  double sum = 0.0, square = 0.0;
  for (std::uint64_t i = 0; i < n; ++i) {
    RayRandom random(11, i);
    const double x = f(source.ray(i, random));
    sum += x;
    square += x * x;
  }
  const double m = sum / n;
  return {m, std::sqrt(std::max(0.0, square / n - m * m) / n) + 1e-12};
}

void expect_mean(const Source& source, double expected, const std::function<double(const SourceRay&)>& f) {
  const Mean m = mean(source, f);
  EXPECT_NEAR(m.value, expected, 5.0 * m.error);
}

// Lambert's law: the cosine to the normal has mean 2/3 and mean square 1/2.
TEST(EmitterStatistical, DiskIsEvenAndLambertian) {
  const auto disk = emitter({{"emitter", "disk"}, {"radius_mm", 2.0}});
  expect_mean(*disk, 2.0 / 3.0, [](const SourceRay& r) { return r.direction.z; });
  expect_mean(*disk, 0.5, [](const SourceRay& r) { return r.direction.z * r.direction.z; });
  expect_mean(*disk, 2.0, [](const SourceRay& r) { return dot(r.origin, r.origin); });
  expect_mean(*disk, 0.0, [](const SourceRay& r) { return r.direction.x; });
  expect_mean(*disk, 1.0, [](const SourceRay& r) { return length(r.direction); });
}

TEST(EmitterStatistical, RectangleIsEven) {
  const auto source = emitter({{"emitter", "rectangle"}, {"size_mm", {2.0, 1.0}}});
  expect_mean(*source, 4.0 / 12.0, [](const SourceRay& r) { return r.origin.x * r.origin.x; });
  expect_mean(*source, 1.0 / 12.0, [](const SourceRay& r) { return r.origin.y * r.origin.y; });
}

TEST(EmitterStatistical, CylinderIsLambertianOutwards) {
  const auto source = emitter({{"emitter", "cylinder"}, {"radius_mm", 1.5}, {"length_mm", 4.0}});
  expect_mean(*source, 2.0 / 3.0, [](const SourceRay& r) {
    return (r.origin.x * r.direction.x + r.origin.y * r.direction.y) / 1.5;
  });
  expect_mean(*source, 16.0 / 12.0, [](const SourceRay& r) { return r.origin.z * r.origin.z; });
}

// Shares of the dies' squares by their centres' signs: 99 % of 1/4, 0.95/4, 1.05/4, 1/4, and a quarter of the
// stray 1 %, a disk about the centre.
TEST(EmitterStatistical, LedHasItsDies) {
  const auto led = emitter({{"emitter", "led"}});
  const double shares[4] = {0.25, 0.2375, 0.2625, 0.25};
  for (int die = 0; die < 4; ++die) {
    expect_mean(*led, 0.99 * shares[die] + 0.0025, [die](const SourceRay& r) {
      return (r.origin.x > 0.0) == (die % 2 == 1) && (r.origin.y > 0.0) == (die >= 2) ? 1.0 : 0.0;
    });
  }
  // Beyond the dies, which reach to 1.05 mm: the stray light less its part in the square of 2.1 mm.
  expect_mean(*led, 0.01 * (1.0 - 2.1 * 2.1 / (std::numbers::pi * 6.25)), [](const SourceRay& r) {
    return std::max(std::abs(r.origin.x), std::abs(r.origin.y)) > 1.05 ? 1.0 : 0.0;
  });
}

// Every start is on the wire or its image, 0.06 mm from the coil's line; light leaves it.
TEST(Emitter, FilamentIsTheCoil) {
  const auto coil =
      emitter({{"emitter", "filament"}, {"radius_mm", 0.6}, {"length_mm", 8.0}, {"ghost_share", 0.0}});
  for (std::uint64_t i = 0; i < 200; ++i) {
    RayRandom random(5, i);
    const SourceRay r = coil->ray(i, random);
    double nearest = 1e9;
    Vec3 out;
    for (int k = 0; k <= 240'000; ++k) {
      const double s = k / 240'000.0, angle = 24.0 * std::numbers::pi * s;
      const Vec3 on{8.0 * (s - 0.5), 0.6 * std::cos(angle), 0.6 * std::sin(angle)};
      if (length(r.origin - on) < nearest) {
        nearest = length(r.origin - on);
        out = r.origin - on;
      }
    }
    EXPECT_NEAR(nearest, 0.06, 1e-5);
    EXPECT_GT(dot(out, r.direction), -1e-4);
  }
}

// The outside of a turn is longer: uniform over the surface, the mean of cos phi is half of wire radius times
// curvature.
TEST(EmitterStatistical, FilamentIsEvenOverItsBentSurface) {
  const auto coil =
      emitter({{"emitter", "filament"}, {"radius_mm", 0.6}, {"length_mm", 8.0}, {"ghost_share", 0.0}});
  const double w = 24.0 * std::numbers::pi, curvature = 0.6 * w * w / (64.0 + 0.36 * w * w);
  const Mean m = mean(*coil, [](const SourceRay& r) { return std::hypot(r.origin.y, r.origin.z); });
  // To first order in the wire's radius: 0.6 + 0.06 <cos phi>, and 0.06^2 <sin^2> / 2 / 0.6 for the rest.
  EXPECT_NEAR(m.value, 0.6 + 0.06 * 0.5 * 0.06 * curvature, 5.0 * m.error + 1e-4);
}

TEST(EmitterStatistical, StripHasItsHalves) {
  const auto strip =
      emitter({{"emitter", "strip"}, {"half_width_mm", 1.0}, {"right_to_left_luminance", 3.0}});
  expect_mean(*strip, 0.75, [](const SourceRay& r) { return r.origin.x > 0.0 ? 1.0 : 0.0; });
  expect_mean(*strip, 1.0 / 3.0, [](const SourceRay& r) { return r.direction.x * r.direction.x; });
  expect_mean(*strip, std::numbers::pi / 4.0, [](const SourceRay& r) { return r.direction.z; });
}

TEST(Emitter, RefusesWhatItCannotBe) {
  EXPECT_EQ(refusal([] {
              emitter({{"emitter", "sun"}});
            }),
            "task.json: /emitter: found \"sun\", expected one of point, disk, rectangle, cylinder, led, "
            "filament, strip");
  EXPECT_EQ(refusal([] {
              emitter({{"emitter", "disk"}, {"radius_mm", -1}});
            }),
            "task.json: /radius_mm: found -1, expected a number > 0");
  EXPECT_NE(refusal([] {
              emitter({{"emitter", "led"}, {"colour", 1}});
            }).find("the unknown key colour"),
            std::string::npos);
}

/// A TM-25 file of `n` rays along +z from (i, 0, 0) with flux i % 2 + 1.
std::string tm25_bytes(std::uint64_t n) {
  std::string head(36288, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  std::memcpy(head.data(), "TM25", 4);
  put(4, std::int32_t{2013});
  put(20, n);
  for (const std::size_t flag : {0, 1, 4}) put(256 + 4 * flag, std::int32_t{1});
  for (std::uint64_t i = 0; i < n; ++i) {
    const float v[7] = {static_cast<float>(i), 0, 0, 0, 0, 1, static_cast<float>(i % 2 + 1)};
    head.append(reinterpret_cast<const char*>(v), sizeof v);
  }
  return head;
}

TEST(FrozenRays, AreReadAndPlaced) {
  const TestFolder folder;
  const auto rays = read_tm25(folder.write("a.tm25ray", tm25_bytes(4)),
                              Frame{{0, 0, 5}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
  RayRandom random(1, 1);
  ASSERT_EQ(rays->count(), 4u);
  EXPECT_EQ(rays->ray(3, random).origin.x, 3.0);
  EXPECT_EQ(rays->ray(3, random).origin.z, 5.0);
  EXPECT_EQ(rays->ray(3, random).direction.z, -1.0);
  EXPECT_DOUBLE_EQ(rays->ray(2, random).weight, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(rays->ray(3, random).weight, 4.0 / 3.0);
}

TEST(FrozenRays, DamagedFilesAreRefusedWithTheirByte) {
  const TestFolder folder;
  const auto message = [&](std::string bytes) {
    return refusal([&] { read_tm25(folder.write("a.tm25ray", bytes), Frame()); });
  };
  EXPECT_EQ(message(tm25_bytes(4)), "");
  EXPECT_NE(message("TM25").find("byte 0: found 4 bytes, expected a header"), std::string::npos);
  EXPECT_NE(message(tm25_bytes(4).substr(0, 36300)).find("byte 20: found 4 rays"), std::string::npos);
  std::string other = tm25_bytes(4);
  other[0] = 'X';
  EXPECT_NE(message(other).find("byte 0: found other bytes, expected TM25"), std::string::npos);
  std::string bent = tm25_bytes(4);
  const float two = 2.0F;
  std::memcpy(bent.data() + 36288 + 28 + 20, &two, 4);
  EXPECT_NE(message(bent).find("byte 36316: found a ray out of range"), std::string::npos);
}

}  // namespace
}  // namespace bench::test
