// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

constexpr std::size_t kRays = 200'000;

const std::vector<EmitterKind> kAllKinds{EmitterKind::point,    EmitterKind::disk,     EmitterKind::rectangle,
                                         EmitterKind::cylinder, EmitterKind::sphere,   EmitterKind::filament,
                                         EmitterKind::led,      EmitterKind::phong500, EmitterKind::phong25,
                                         EmitterKind::radial,   EmitterKind::cosine};

RayBlock draw(const EmitterOptions& options, SequenceKind kind = SequenceKind::random,
              std::size_t n = kRays) {
  RayBlock block;
  block.resize(n);
  make_emitter(options)->emit(Sequence(kind, 3), 0, block);
  return block;
}

/// A number in [0, 1) that is uniform when the emitter has the density its table states.
using Coordinate = std::function<double(const Ray&)>;

/// Chi-square of a pair of coordinates on 20 x 20 cells.
double pair_p(const RayBlock& rays, const Coordinate& a, const Coordinate& b) {
  std::vector<double> counts(400, 0.0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays.ray(i);
    const auto cell = [](double x) { return static_cast<std::size_t>(std::clamp(20.0 * x, 0.0, 19.999)); };
    counts[20 * cell(b(ray)) + cell(a(ray))] += 1.0;
  }
  return test::chi_square_uniform_p(counts);
}

/// A coordinate whose density is off by `deviation`, root mean square: x^(1 + e) has the density 1 + e (1 +
/// ln x) to first order, and the mean square of 1 + ln x is 1.
Coordinate bent(const Coordinate& x, double deviation) {
  return [=](const Ray& r) { return std::pow(std::max(0.0, x(r)), 1.0 + deviation); };
}

/// Both are uniform and independent, and the test would see if one were not: bent by 1.3 times the deviation
/// that 20 x 20 cells show, which leaves room for what is lost inside a cell.
void expect_uniform(const RayBlock& rays, const Coordinate& a, const Coordinate& b) {
  const double wrong = 1.3 * test::seen_deviation(static_cast<double>(rays.size()), 400.0);
  EXPECT_GT(pair_p(rays, a, b), test::kFalseAlarm);
  EXPECT_LT(pair_p(rays, bent(a, wrong), b), test::kFalseAlarm) << "bent by " << wrong;
  EXPECT_LT(pair_p(rays, a, bent(b, wrong)), test::kFalseAlarm) << "bent by " << wrong;
}

double turn(double x, double y) { return std::atan2(y, x) / (2.0 * std::numbers::pi) + 0.5; }
double sine_squared(const Ray& r, const Vec3& normal) {
  const double c = dot(r.direction, normal);
  return 1.0 - c * c;
}

const Coordinate kSineToZ = [](const Ray& r) { return sine_squared(r, {0, 0, 1}); };
const Coordinate kAzimuth = [](const Ray& r) { return turn(r.direction.x(), r.direction.y()); };

TEST(EmitterStatistical, DiskIsUniformAndLambertianAndAnIsotropicOneIsRejected) {
  const RayBlock rays = draw({.kind = EmitterKind::disk, .radius_mm = 2.0});
  const Coordinate radius = [](const Ray& r) { return dot(r.origin_mm, r.origin_mm) / 4.0; };
  const Coordinate around = [](const Ray& r) { return turn(r.origin_mm.x, r.origin_mm.y); };
  expect_uniform(rays, radius, around);
  expect_uniform(rays, kSineToZ, kAzimuth);
  expect_uniform(rays, kSineToZ, radius);
  // The wrong emitter: uniform per solid angle instead of Lambert's cosine.
  const RayBlock isotropic = draw({.kind = EmitterKind::point});
  EXPECT_LT(pair_p(isotropic, kSineToZ, kAzimuth), test::kFalseAlarm);
}

TEST(EmitterStatistical, RectangleIsUniformAndLambertian) {
  const RayBlock rays = draw({.kind = EmitterKind::rectangle, .size_mm = {{4.0, 1.0}}});
  const Coordinate x = [](const Ray& r) { return r.origin_mm.x / 4.0 + 0.5; };
  const Coordinate y = [](const Ray& r) { return r.origin_mm.y + 0.5; };
  expect_uniform(rays, x, y);
  expect_uniform(rays, kSineToZ, kAzimuth);
}

TEST(EmitterStatistical, PointIsIsotropic) {
  const RayBlock rays = draw({.kind = EmitterKind::point});
  expect_uniform(
      rays, [](const Ray& r) { return 0.5 * (1.0 + r.direction.z()); }, kAzimuth);
}

TEST(EmitterStatistical, RoundBodiesAreUniformAndLambertianAboutTheirNormals) {
  const auto check = [](const RayBlock& rays, double half_height,
                        const std::function<Vec3(const Ray&)>& normal) {
    const Coordinate height = [&](const Ray& r) { return 0.5 * (1.0 + r.origin_mm.z / half_height); };
    const Coordinate around = [](const Ray& r) { return turn(r.origin_mm.x, r.origin_mm.y); };
    const Coordinate sine = [&](const Ray& r) { return sine_squared(r, normal(r)); };
    expect_uniform(rays, height, around);
    expect_uniform(rays, height, sine);
    expect_uniform(rays, around, sine);
    for (std::size_t i = 0; i < rays.size(); i += 97)
      EXPECT_GE(dot(rays.direction(i), normal(rays.ray(i))), -1e-6);
  };
  check(draw({.kind = EmitterKind::cylinder, .radius_mm = 0.5, .length_mm = 8.0}), 4.0, [](const Ray& r) {
    return Vec3{r.origin_mm.x, r.origin_mm.y, 0.0} / 0.5;
  });
  check(draw({.kind = EmitterKind::sphere, .radius_mm = 3.0}), 3.0,
        [](const Ray& r) { return r.origin_mm / 3.0; });
}

TEST(EmitterStatistical, PhongLobesHaveTheirExponents) {
  const auto lobe = [](double exponent) {
    return Coordinate([=](const Ray& r) {
      return std::pow(std::max(0.0, dot(r.direction, Direction::from(r.origin_mm))), exponent + 1.0);
    });
  };
  const Coordinate height = [](const Ray& r) { return 0.5 * (1.0 + r.origin_mm.z / 10.0); };
  const RayBlock p500 = draw({.kind = EmitterKind::phong500});
  EXPECT_GT(pair_p(p500, lobe(500.0), height), test::kFalseAlarm);
  EXPECT_LT(pair_p(p500, lobe(530.0), height), test::kFalseAlarm) << "a wrong exponent must be seen";
  const RayBlock p25 = draw({.kind = EmitterKind::phong25});
  EXPECT_GT(pair_p(p25, lobe(25.0), kAzimuth), test::kFalseAlarm);
  EXPECT_LT(pair_p(p25, lobe(26.5), kAzimuth), test::kFalseAlarm) << "a wrong exponent must be seen";
}

/// Observed and expected counts of alternating cells, bright ones 1 and dim ones 0.25.
double pattern_p(const RayBlock& rays, std::size_t cells, const std::function<std::size_t(const Ray&)>& cell,
                 const std::function<bool(std::size_t)>& bright) {
  std::vector<double> observed(cells, 0.0), expected(cells);
  for (std::size_t i = 0; i < rays.size(); ++i) observed[cell(rays.ray(i))] += 1.0;
  for (std::size_t c = 0; c < cells; ++c) {
    expected[c] =
        (bright(c) ? 1.0 : 0.25) * static_cast<double>(rays.size()) / (0.625 * static_cast<double>(cells));
  }
  return test::chi_square_p(observed, expected);
}

TEST(EmitterStatistical, PatternsAreTheOnesDocumented) {
  const auto band = [](double z, int bands) {
    return std::min(static_cast<int>(bands * 0.5 * (1.0 - z)), bands - 1);
  };
  const auto bands_p = [&](EmitterKind kind) {
    return pattern_p(
        draw({.kind = kind}), 6,
        [&](const Ray& r) { return static_cast<std::size_t>(band(r.direction.z(), 6)); },
        [](std::size_t c) { return c % 2 == 0; });
  };
  EXPECT_GT(bands_p(EmitterKind::phong25), test::kFalseAlarm);
  EXPECT_LT(bands_p(EmitterKind::phong500), test::kFalseAlarm) << "a set without the pattern must be seen";
  const auto sectors_p = [&](EmitterKind kind, bool shifted) {
    return pattern_p(
        draw({.kind = kind}), 128,
        [&](const Ray& r) {
          const double azimuth = std::atan2(r.origin_mm.y, r.origin_mm.x) / (2.0 * std::numbers::pi);
          const int sector = std::min(static_cast<int>(16.0 * (azimuth < 0.0 ? azimuth + 1.0 : azimuth)), 15);
          return static_cast<std::size_t>(16 * band(r.origin_mm.z / 10.0, 8) + sector);
        },
        [=](std::size_t c) { return (c / 16 + c % 16 + (shifted && c < 2 ? 1 : 0)) % 2 == 0; });
  };
  for (const EmitterKind kind : {EmitterKind::radial, EmitterKind::cosine}) {
    EXPECT_GT(sectors_p(kind, false), test::kFalseAlarm) << to_string(kind);
    EXPECT_LT(sectors_p(kind, true), test::kFalseAlarm) << "two cells of 128 the other way must be seen";
  }
}

TEST(EmitterStatistical, LedSharesItsFluxAsDocumented) {
  const RayBlock rays = draw({.kind = EmitterKind::led, .surface = BoundingSurface{}});
  std::vector<double> observed(5, 0.0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3 p = rays.origin_mm(i);
    const auto on_die = [](double x) { return std::abs(x) >= 0.05 && std::abs(x) <= 1.05; };
    const std::size_t die = (p.x > 0.0 ? 1u : 0u) + (p.y > 0.0 ? 2u : 0u);
    observed[on_die(p.x) && on_die(p.y) ? die : 4] += 1.0;
  }
  // Stray light falls on the dies too: each has 1 mm2 of the package's 6.25 pi. `off` is moved from die 1 to
  // die 2.
  const auto share_p = [&](double stray, double off) {
    const double stray_per_die = stray / (6.25 * std::numbers::pi), n = static_cast<double>(rays.size());
    std::vector<double> expected;
    for (const double share : {0.25, 0.2375 - off, 0.2625 + off, 0.25})
      expected.push_back(n * ((1.0 - stray) * share + stray_per_die));
    expected.push_back(n * (stray - 4.0 * stray_per_die));
    return test::chi_square_p(observed, expected);
  };
  EXPECT_GT(share_p(0.01, 0.0), test::kFalseAlarm);
  // A share s that is off by o adds o^2 / s to the square of the deviation.
  const double seen = test::seen_deviation(static_cast<double>(rays.size()), 5.0);
  EXPECT_LT(share_p(0.01, 1.2 * seen * std::sqrt(0.125)), test::kFalseAlarm);
  EXPECT_LT(share_p(0.01 + 1.2 * seen * std::sqrt(0.01), 0.0), test::kFalseAlarm);
}

TEST(EmitterStatistical, FilamentIsEvenAlongTheCoilAndItsImageHasItsShare) {
  const RayBlock rays =
      draw({.kind = EmitterKind::filament, .ghost_share = 0.0, .surface = BoundingSurface{}});
  const Coordinate along = [](const Ray& r) { return r.origin_mm.x / 8.0 + 0.5; };
  const double wrong = 1.3 * test::seen_deviation(0.8 * static_cast<double>(rays.size()), 40.0);
  std::vector<double> counts(40, 0.0), bent_counts(40, 0.0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3 p = rays.origin_mm(i);
    EXPECT_NEAR(std::hypot(p.y, p.z), 0.6, 0.0601);
    const double x = along(rays.ray(i));
    // The wire's own thickness blurs the two ends; count the rest.
    if (x < 0.1 || x >= 0.9) continue;
    counts[static_cast<std::size_t>(50.0 * (x - 0.1))] += 1.0;
    bent_counts[static_cast<std::size_t>(40.0 * std::pow((x - 0.1) / 0.8, 1.0 + wrong))] += 1.0;
  }
  EXPECT_GT(test::chi_square_uniform_p(counts), test::kFalseAlarm);
  EXPECT_LT(test::chi_square_uniform_p(bent_counts), test::kFalseAlarm) << "bent by " << wrong;
}

TEST(Emitter, RaysStartOnTheirSurfaceAndGoOutward) {
  const std::vector<BoundingSurface> surfaces{BoundingSurface::sphere(12.0),
                                              BoundingSurface::cylinder(11.0, 25.0),
                                              BoundingSurface::box({24.0, 22.0, 26.0})};
  for (const EmitterKind kind : kAllKinds) {
    for (const BoundingSurface& surface : surfaces) {
      const RayBlock rays = draw({.kind = kind, .surface = surface}, SequenceKind::sobol, 2000);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_NEAR(surface.outside_mm(rays.origin_mm(i)), 0.0, 2e-6) << to_string(kind);
        EXPECT_GT(surface.outside_mm(rays.ray(i).at(0.01)), 0.0) << to_string(kind);
      }
    }
  }
}

TEST(Emitter, SlidingToASurfaceKeepsTheLine) {
  const RayBlock bare = draw({.kind = EmitterKind::disk}, SequenceKind::random, 500);
  const RayBlock lifted =
      draw({.kind = EmitterKind::disk, .surface = BoundingSurface::plane(2.0)}, SequenceKind::random, 500);
  for (std::size_t i = 0; i < bare.size(); ++i) {
    EXPECT_EQ(bare.direction(i), lifted.direction(i));
    const Vec3 moved = lifted.origin_mm(i) - bare.origin_mm(i);
    EXPECT_LT(length(cross(moved, bare.direction(i))), 1e-6 * (1.0 + length(moved)));
    EXPECT_NEAR(lifted.z_mm[i], 2.0, 1e-6);
  }
}

TEST(Emitter, PiecesOfTheStreamAreTheStream) {
  for (const EmitterKind kind : kAllKinds) {
    for (const SequenceKind sequence : {SequenceKind::random, SequenceKind::sobol}) {
      const auto emitter = make_emitter({.kind = kind});
      RayBlock whole, piece, joined;
      whole.resize(300);
      emitter->emit(Sequence(sequence, 5), 1000, whole);
      for (const std::size_t n : {1u, 99u, 200u}) {
        piece.resize(n);
        emitter->emit(Sequence(sequence, 5), 1000 + joined.size(), piece);
        joined.append(piece);
      }
      EXPECT_EQ(whole, joined) << to_string(kind);
    }
  }
}

TEST(Emitter, BadSizesAreNamed) {
  const auto message = [](const EmitterOptions& options) -> std::string {
    try {
      make_emitter(options);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message({.kind = EmitterKind::disk, .radius_mm = -1.0}).find("radius_mm is -1"),
            std::string::npos);
  EXPECT_NE(message({.kind = EmitterKind::disk, .flux = 0.0}).find("flux is 0"), std::string::npos);
  EXPECT_NE(message({.kind = EmitterKind::disk, .flux = std::nan("")}).find("flux"), std::string::npos);
  EXPECT_NE(message({.kind = EmitterKind::filament, .ghost_share = 1.0}).find("ghost_share"),
            std::string::npos);
  EXPECT_NE(message({.kind = EmitterKind::cylinder, .surface = BoundingSurface::sphere(2.0)}).find("outside"),
            std::string::npos);
  EXPECT_NE(message({.kind = EmitterKind::disk, .radius_mm = 1e300}).find("expected at most 1e+09 mm"),
            std::string::npos);
  EXPECT_EQ(message({.kind = EmitterKind::disk, .length_mm = 3.0}),
            "found length_mm, which a disk does not have");
  EXPECT_NE(message({.kind = EmitterKind::led, .radius_mm = 1.0}), "");
  EXPECT_NE(message({.kind = EmitterKind::sphere, .size_mm = {{1.0, 1.0}}}), "");
  EXPECT_NE(message({.kind = EmitterKind::cylinder, .ghost_share = 0.1}), "");
  for (const EmitterKind kind : kAllKinds) EXPECT_EQ(message({.kind = kind}), "");
  EXPECT_THROW(emitter_kind("torch"), UsageError);
  for (const EmitterKind kind : kAllKinds) EXPECT_EQ(emitter_kind(to_string(kind)), kind);
}

}  // namespace
}  // namespace lucerna
