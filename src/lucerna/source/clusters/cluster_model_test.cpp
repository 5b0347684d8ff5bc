// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/source.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/file/nfl.h"
#include "tests/support/print_parameters.h"
#include "tests/support/statistics.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

RaySet emitter_rays(EmitterKind kind, std::size_t n, std::uint64_t seed,
                    std::optional<BoundingSurface> surface = {}) {
  EmitterOptions options;
  options.kind = kind;
  options.surface = surface;
  options.flux = 337.125;
  const auto source = make_emitter(options);
  RaySet set;
  set.header.set_flux(source->flux());
  set.rays = draw_rays(*source, Sequence(SequenceKind::random, seed), n);
  return set;
}

/// A small model with coarse directions, so that each has many samples.
std::unique_ptr<ClusterModel> small_model(EmitterKind kind, std::optional<BoundingSurface> surface = {}) {
  ClusterOptions options;
  options.penalty_nats = 60.0;
  return compress_clusters(emitter_rays(kind, 30'000, 1, surface), options);
}

constexpr std::size_t kBands = 12, kSectors = 16;

/// Place of a sphere's point in bands of equal area by sectors of azimuth.
std::size_t place_on_sphere(const MeshSurface& sphere, const Vec3& point_mm) {
  const Vec3 d = (1.0 / sphere.radius_mm) * (point_mm - sphere.centre_mm);
  const double phi = std::atan2(d.y, d.x) / (2.0 * std::numbers::pi) + 0.5;
  const auto cell = [](double x, std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(std::max(0.0, x) * static_cast<double>(n)));
  };
  return cell(0.5 * (d.z + 1.0), kBands) * kSectors + cell(phi, kSectors);
}

/// Integral of pdf_area over each of those places: midpoints of 16 x 16 equal parts.
std::vector<double> integrated_pdf_area(const ClusterModel& model) {
  constexpr std::size_t kParts = 16;
  const MeshSurface& sphere = model.data().surface;
  const double part_mm2 = 4.0 * std::numbers::pi * sphere.radius_mm * sphere.radius_mm /
                          static_cast<double>(kBands * kSectors * kParts * kParts);
  std::vector<double> result(kBands * kSectors, 0.0);
  for (std::size_t i = 0; i < kBands * kParts; ++i) {
    const double z = 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(kBands * kParts) - 1.0;
    const double r = std::sqrt(1.0 - z * z);
    for (std::size_t k = 0; k < kSectors * kParts; ++k) {
      const double phi =
          2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(kSectors * kParts) -
          std::numbers::pi;
      const Vec3 p = sphere.centre_mm + sphere.radius_mm * Vec3{r * std::cos(phi), r * std::sin(phi), z};
      result[i / kParts * kSectors + k / kParts] += part_mm2 * model.pdf_area(p);
    }
  }
  return result;
}

class ClusterModelPdfStatistical : public testing::TestWithParam<EmitterKind> {
 protected:
  std::unique_ptr<ClusterModel> model() const {
    ClusterOptions options;
    options.max_bytes = 6000;
    const auto sphere = BoundingSurface::sphere(GetParam() == EmitterKind::disk ? 3.0 : 10.0);
    return compress_clusters(emitter_rays(GetParam(), 20'000, 1, sphere), options);
  }
};

TEST_P(ClusterModelPdfStatistical, AreaIntegratesToOneAndIsWhereSamplesStart) {
  const auto source = model();
  ASSERT_EQ(source->data().surface.kind, MeshSurfaceKind::sphere);
  constexpr std::size_t kSamples = 50'000;
  std::vector<double> expected = integrated_pdf_area(*source);
  const double whole = std::accumulate(expected.begin(), expected.end(), 0.0);
  EXPECT_NEAR(whole, 1.0, 2e-3);
  for (double& x : expected) x *= kSamples / whole;
  std::vector<double> observed(expected.size(), 0.0), wrong(expected.size(), 0.0);
  const Sequence sequence(SequenceKind::random, 5);
  for (std::size_t i = 0; i < kSamples; ++i) {
    auto u = sequence.point<6>(i);
    observed[place_on_sphere(source->data().surface, source->sample(u).origin_mm)] += 1.0;
    u[0] = std::pow(u[0], 1.2);  // prefers the elements that come first
    wrong[place_on_sphere(source->data().surface, source->sample(u).origin_mm)] += 1.0;
  }
  EXPECT_GT(test::chi_square_p(observed, expected), test::kFalseAlarm);
  EXPECT_LT(test::chi_square_p(wrong, expected), test::kFalseAlarm);
}

TEST(ClusterModelStatistical, PointsInLargeTrianglesFollowPdfArea) {
  const auto model = small_model(EmitterKind::disk);
  ASSERT_EQ(model->data().surface.kind, MeshSurfaceKind::plane);
  constexpr std::size_t kCells = 16, kParts = 16, kSamples = 100'000;
  constexpr double kReach = 1.001, kPart = 2.0 * kReach / (kCells * kParts);
  std::vector<double> expected(kCells * kCells, 0.0), observed(expected), wrong(expected);
  for (std::size_t i = 0; i < kCells * kParts; ++i) {
    for (std::size_t k = 0; k < kCells * kParts; ++k) {
      const Vec3 p{(static_cast<double>(i) + 0.5) * kPart - kReach,
                   (static_cast<double>(k) + 0.5) * kPart - kReach, 0.0};
      expected[i / kParts * kCells + k / kParts] += kPart * kPart * model->pdf_area(p);
    }
  }
  const double whole = std::accumulate(expected.begin(), expected.end(), 0.0);
  EXPECT_NEAR(whole, 1.0, 1e-3);
  for (double& x : expected) x *= kSamples / whole;
  // Midpoints are too coarse for cells that the rim crosses: they count as one.
  const auto with_one_rim = [&](const std::vector<double>& cells) {
    std::vector<double> result(1, 0.0);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto far = [&](std::size_t n) {
        return std::abs(static_cast<double>(2 * n + 1) / kCells - 1.0) + 1.0 / kCells;
      };
      const bool inside = kReach * std::hypot(far(i / kCells), far(i % kCells)) < 0.99;
      if (inside) result.push_back(cells[i]);
      if (!inside) result[0] += cells[i];
    }
    return result;
  };
  const auto count = [&](const Vec3& p, std::vector<double>& cells) {
    const auto step = [](double x) {
      return static_cast<std::size_t>((x + kReach) / (2.0 * kReach) * kCells);
    };
    cells.at(step(p.x) * kCells + step(p.y)) += 1.0;
  };
  const Sequence sequence(SequenceKind::random, 7);
  for (std::size_t i = 0; i < kSamples; ++i) {
    auto u = sequence.point<6>(i);
    count(model->sample(u).origin_mm, observed);
    u[1] = std::pow(u[1], 1.5);  // draws points away from the corner that was chosen
    count(model->sample(u).origin_mm, wrong);
  }
  EXPECT_GT(test::chi_square_p(with_one_rim(observed), with_one_rim(expected)), test::kFalseAlarm);
  EXPECT_LT(test::chi_square_p(with_one_rim(wrong), with_one_rim(expected)), test::kFalseAlarm);
}

TEST_P(ClusterModelPdfStatistical, SolidAngleIntegratesToOneAndIsWhereSamplesGoFromAStart) {
  const auto source = model();
  constexpr int kCellDepth = 3, kPartDepth = 6;
  constexpr std::size_t kSamples = 20'000, kCells = kDirectionCodes / direction_span(kCellDepth);
  for (const ClusterLeaf& leaf : source->data().leaf) ASSERT_LE(leaf.depth, kPartDepth);  // parts are exact
  const Sequence sequence(SequenceKind::random, 6);
  for (std::uint64_t start = 0; start < 4; ++start) {
    auto u = sequence.point<6>(start);
    const Vec3 p = source->sample(u).origin_mm;
    std::vector<double> expected(kCells, 0.0), observed(kCells, 0.0), wrong(kCells, 0.0);
    for (std::uint32_t code = 0; code < kDirectionCodes; code += direction_span(kPartDepth)) {
      const SphericalTriangle t = direction_triangle(code, kPartDepth);
      expected[code / direction_span(kCellDepth)] +=
          kSamples * t.solid_angle_sr() * source->pdf_solid_angle(p, Direction::from(t.a + t.b + t.c));
    }
    EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0) / kSamples, 1.0, 1e-9);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const auto v = sequence.point<6>(1000 + i);
      const auto count = [&](double leaf, std::vector<double>& cells) {
        const Ray ray = source->sample({u[0], u[1], u[2], leaf, v[4], v[5]});
        cells[direction_code(ray.direction) / direction_span(kCellDepth)] += 1.0;
      };
      count(v[3], observed);
      count(std::pow(v[3], 1.3), wrong);  // prefers the leaves that come first
    }
    EXPECT_GT(test::chi_square_p(observed, expected), test::kFalseAlarm) << start;
    EXPECT_LT(test::chi_square_p(wrong, expected), test::kFalseAlarm) << start;
  }
}

INSTANTIATE_TEST_SUITE_P(Emitters, ClusterModelPdfStatistical,
                         testing::Values(EmitterKind::disk, EmitterKind::cosine),
                         [](const auto& p) { return std::string(to_string(p.param)); });

TEST(ClusterModel, PdfEtendueIsTheProductOverTheCosine) {
  const auto model = small_model(EmitterKind::cosine);
  const Ray ray = model->sample({0.3, 0.2, 0.6, 0.4, 0.5, 0.1});
  const double cosine = std::abs(dot(model->data().surface.normal(ray.origin_mm), ray.direction));
  EXPECT_NEAR(model->pdf_etendue(ray) * cosine,
              model->pdf_area(ray.origin_mm) * model->pdf_solid_angle(ray.origin_mm, ray.direction), 1e-12);
  EXPECT_GT(model->pdf_area(ray.origin_mm), 0.0);
  EXPECT_GT(model->pdf_solid_angle(ray.origin_mm, ray.direction), 0.0);
  EXPECT_EQ(model->pdf_area({0, 0, 0}), 0.0);
}

TEST(ClusterModel, FileGivesTheSameRaysToTheBit) {
  const test::TempDir dir;
  const auto model = small_model(EmitterKind::filament);
  const std::uint64_t bytes = save_source_model(dir / "a.nfl", *model);
  EXPECT_EQ(bytes, std::filesystem::file_size(dir / "a.nfl"));
  EXPECT_TRUE(is_source_model(dir / "a.nfl"));
  write_file(dir / "b", "\x89NFX");
  EXPECT_FALSE(is_source_model(dir / "b"));
  EXPECT_FALSE(is_source_model(dir / "none"));
  const auto back = load_source_model(dir / "a.nfl");
  EXPECT_EQ(back->method(), "clusters");
  EXPECT_EQ(back->flux(), 337.125);
  EXPECT_EQ(back->training_rays(), 30'000u);
  EXPECT_EQ(dynamic_cast<const ClusterModel&>(*back).data(), model->data());
  const Sequence sequence(SequenceKind::sobol, 3);
  EXPECT_EQ(draw_rays(*back, sequence, 1000), draw_rays(*model, sequence, 1000));
}

TEST(ClusterModel, StoredLevelsComeBack) {
  for (int q = 0; q < 65536; ++q)
    EXPECT_EQ(density_level(relative_density_of(static_cast<std::uint16_t>(q))), q);
  for (int q = 0; q < 256; ++q) EXPECT_EQ(weight_level(relative_weight_of(static_cast<std::uint8_t>(q))), q);
  EXPECT_EQ(weight_level(0.0), 0);
  EXPECT_EQ(weight_level(1e-30), 1);
}

/// Everything behind the checksum must hold on its own: random damage to the sections of a valid file.
TEST(ClusterModelFuzz, DamagedSectionsAreRefusedOrHarmless) {
  ClusterOptions options;
  options.max_bytes = 2000;
  const auto file_of = [&](const BoundingSurface& surface) {
    return compress_clusters(emitter_rays(EmitterKind::disk, 5'000, 1, surface), options)->to_nfl();
  };
  const NflFile plane = file_of(BoundingSurface::plane(0.0)), sphere = file_of(BoundingSurface::sphere(2.0));
  int refused = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    NflFile bad = i % 6 == 0 ? sphere : plane;  // a sphere's mesh takes ten times as long
    Rng rng(9, i);
    auto& section =
        bad.sections[static_cast<std::size_t>(rng.uniform() * static_cast<double>(bad.sections.size()))]
            .bytes;
    const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(section.size()));
    const double kind = rng.uniform();
    if (kind < 0.6) {
      section[at] = static_cast<char>(rng.bits());
    } else if (kind < 0.8) {
      section.resize(at);
    } else {
      section.insert(at, 1 + rng.bits() % 9, static_cast<char>(rng.bits()));
    }
    try {
      // Packing and unpacking (zstd, SHA-256) change no byte: every eighth does it all the same.
      if (i % 8 == 0) bad = decode_nfl(encode_nfl(bad), "bad.nfl");
      const auto model = ClusterModel::from_nfl(bad, "bad.nfl");
      const Ray ray = model->sample({0.5, 0.5, 0.5, 0.5, 0.5, 0.5});
      EXPECT_NEAR(length(ray.direction), 1.0, 1e-6);
    } catch (const InputError& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find("bad.nfl: "), 0u) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
  EXPECT_GT(refused, 500);
}

/// Even points stay evener than random ones through alias tables and triangles: the same means with less
/// noise.
TEST(ClusterModelStatistical, SobolPointsAreEvener) {
  const auto model = small_model(EmitterKind::cosine);
  constexpr std::size_t kScrambles = 192, kPoints = 4096;
  const auto spread = [&](SequenceKind kind) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < kScrambles; ++k) {
      const RayBlock rays = draw_rays(*model, Sequence(kind, 50 + k), kPoints);
      double mean = 0.0;
      for (std::size_t i = 0; i < kPoints; ++i) mean += static_cast<double>(rays.kz[i]) / kPoints;
      sum += mean;
      squares += mean * mean;
    }
    return squares / kScrambles - sum * sum / (kScrambles * kScrambles);
  };
  // Equal variances would differ by that much with a chance of 1e-6 (F test, 191 and 191 degrees of freedom).
  EXPECT_LT(spread(SequenceKind::sobol) * 2.05, spread(SequenceKind::random));
}

TEST(ClusterModelFuzz, EveryCutOfAFileIsOneClearLine) {
  const test::TempDir dir;
  const auto model = small_model(EmitterKind::disk, BoundingSurface::sphere(2.0));
  save_source_model(dir / "a.nfl", *model);
  const std::string bytes = read_file(dir / "a.nfl", 1 << 24);
  for (std::size_t n = 0; n < bytes.size(); n += n < 256 ? 1 : 97) {
    EXPECT_THROW(decode_nfl(std::string_view(bytes).substr(0, n), "x"), InputError);
  }
  write_file(dir / "cut.nfl", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(load_source_model(dir / "cut.nfl"), InputError);
}

}  // namespace
}  // namespace lucerna
