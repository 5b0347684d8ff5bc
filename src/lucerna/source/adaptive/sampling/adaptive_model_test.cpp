// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/sampling/adaptive_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/file/nfl.h"
#include "tests/support/paths.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

RaySet drawn_on(EmitterKind kind, std::size_t n, std::optional<BoundingSurface> surface = {}) {
  EmitterOptions options;
  options.kind = kind;
  options.surface = surface;
  const auto emitter = make_emitter(options);
  RaySet set;
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, 3), n);
  set.header.set_flux(emitter->flux());
  return set;
}

/// A model that needs no search: two layers, one of two trees, on a sphere of 2 mm.
AdaptiveData small_data() {
  AdaptiveData data;
  data.flux = 100.0;
  data.training_rays = 5000;
  data.surface = BoundingSurface::sphere(2.0);
  AdaptiveLayer disk;
  disk.support.kind = SupportKind::disk;
  disk.support.map = PolarMap::polar;
  disk.share = 0.75;
  disk.why = "for the test";
  AdaptiveChart chart{
      0,
      1.0,
      {{0.0, -std::numbers::pi, 0.0, -std::numbers::pi}, {0.5, std::numbers::pi, 0.5, std::numbers::pi}},
      {}};
  DensityTree tree;
  tree.rays = 4000.0;
  tree.nodes = {{2, 0, 16, 40}, {}, {2, 3, 48, -9}, {}, {}};
  chart.trees = {tree};
  tree.nodes = {{4, 2, 20, kRightEmpty}, {2, 1, 7, 3}, {}, {}, {}};
  chart.trees.push_back(tree);
  disk.charts = {chart};
  AdaptiveLayer rest;
  rest.share = 0.25;
  tree.nodes = {{}};
  rest.charts = {{0, 1.0, {{-1, -1, -1, -std::numbers::pi}, {1, 1, 1, std::numbers::pi}}, {tree}}};
  data.layers = {disk, rest};
  return data;
}

/// The same with its first layer seen through a dome and two bands of wavelengths: version 2 of the format.
AdaptiveData dome_data() {
  AdaptiveData data = small_data();
  data.layers.front().support.dome = {{0.1, 0.0, -0.2}, 1.8, 1.4};
  data.layers.back().band = 1;
  data.wavelengths = {{{0.0f, 0.25f, 1.0f}, {440.0f, 450.0f, 480.0f}}, {{0.0f, 1.0f}, {600.0f, 600.0f}}};
  return data;
}

TEST(AdaptiveModel, SurvivesItsFile) {
  AdaptiveData data = dome_data();
  data.spectra = {{{400.0f, 500.0f}, {0.25f, 1.0f}}};
  const NflFile file = decode_nfl(encode_nfl(encode_adaptive(data)), "test");
  const AdaptiveData back = decode_adaptive(file, "test");
  EXPECT_EQ(back.layers, data.layers);
  EXPECT_EQ(back.spectra, data.spectra);
  EXPECT_EQ(back.wavelengths, data.wavelengths);
  EXPECT_EQ(back.flux, data.flux);
  EXPECT_EQ(back.training_rays, data.training_rays);
  EXPECT_EQ(back.surface.kind, data.surface.kind);
  const AdaptiveModel a(data), b(back);
  EXPECT_EQ(draw_rays(a, Sequence(SequenceKind::random, 1), 1000),
            draw_rays(b, Sequence(SequenceKind::random, 1), 1000));
}

TEST(AdaptiveModel, FrozenFileOfVersion1Reads) {
  const std::filesystem::path path = test::source_dir() / "tests/data/adaptive_v1.nfl";
  const auto model = load_source_model(path);
  EXPECT_EQ(model->method(), "adaptive");
  EXPECT_EQ(dynamic_cast<const AdaptiveModel&>(*model).data().layers, small_data().layers);
}

TEST(AdaptiveModel, FrozenFileOfVersion2Reads) {
  const std::filesystem::path path = test::source_dir() / "tests/data/adaptive_v2.nfl";
  const auto model = load_source_model(path);
  const AdaptiveData& data = dynamic_cast<const AdaptiveModel&>(*model).data();
  EXPECT_EQ(data.layers, dome_data().layers);
  EXPECT_EQ(data.wavelengths, dome_data().wavelengths);
}

TEST(AdaptiveModel, ProgramsOfVersion1DoNotMistakeADome) {
  const NflFile plain = encode_adaptive(small_data()), dome = encode_adaptive(dome_data());
  EXPECT_EQ(plain.version, 1u);
  EXPECT_EQ(dome.version, 2u);
  // The kind of the first support, after the surface and the number of layers.
  constexpr std::size_t kKind = 1 + 16 * 8 + 1;
  EXPECT_LT(static_cast<std::uint8_t>(plain.sections[0].bytes[kKind]), kSupportKinds);
  EXPECT_GE(static_cast<std::uint8_t>(dome.sections[0].bytes[kKind]), kSupportKinds);
  EXPECT_EQ(plain.sections[1].bytes, dome.sections[1].bytes);
}

TEST(AdaptiveModelFuzz, DamagedSectionsAreRefusedOrReadable) {
  const NflFile good = encode_adaptive(dome_data());
  int refused = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    Rng rng(9, i);
    NflFile bad = good;
    auto& bytes = bad.sections[rng.bits() % bad.sections.size()].bytes;
    const auto changes = 1 + rng.bits() % 3;
    for (std::uint32_t k = 0; k < changes && !bytes.empty(); ++k) {
      if (rng.bits() % 8 == 0)
        bytes.resize(rng.bits() % bytes.size());
      else
        bytes[rng.bits() % bytes.size()] = static_cast<char>(rng.bits());
    }
    try {
      const AdaptiveModel model(decode_adaptive(bad, "test"));
      for (const float x : draw_rays(model, Sequence(SequenceKind::random, 1), 50).x_mm)
        ASSERT_TRUE(std::isfinite(x));
      std::vector<float> nm(model.has_wavelengths() ? 50 : 0);
      if (!nm.empty()) model.emit_wavelengths(Sequence(SequenceKind::random, 1), 0, nm);
      for (const float x : nm) ASSERT_TRUE(x > 0.0f);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(AdaptiveModel, PiecesOfAStreamAreTheSameBits) {
  const AdaptiveModel model(small_data());
  for (const SequenceKind kind : {SequenceKind::random, SequenceKind::sobol}) {
    const Sequence sequence(kind, 4);
    const RayBlock whole = draw_rays(model, sequence, 3000);
    RayBlock piece;
    piece.resize(1001, 0);
    model.emit(sequence, 1500, piece);
    for (std::size_t i = 0; i < piece.size(); ++i) {
      ASSERT_EQ(piece.x_mm[i], whole.x_mm[1500 + i]);
      ASSERT_EQ(piece.kz[i], whole.kz[1500 + i]);
      ASSERT_EQ(piece.weight[i], 1.0f);
    }
  }
}

TEST(AdaptiveModel, RaysStartOnTheSurface) {
  for (const BoundingSurface& surface : {BoundingSurface::sphere(2.0), BoundingSurface::cylinder(1.5, 3.0),
                                         BoundingSurface::box({3, 3.5, 4}), BoundingSurface::plane(0.5)}) {
    AdaptiveData data = small_data();
    data.surface = surface;
    const RayBlock rays = draw_rays(AdaptiveModel(data), Sequence(SequenceKind::random, 1), 5000);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double far = 1.0 + length(rays.origin_mm(i));
      ASSERT_LT(std::abs(surface.outside_mm(rays.origin_mm(i))), 1e-5 * far) << to_string(surface.kind);
      ASSERT_NEAR(length(Vec3{rays.kx[i], rays.ky[i], rays.kz[i]}), 1.0, 1e-6);
    }
  }
}

/// p-value for rays from `sample` falling in boxes of plane position and direction as often as the model's
/// density says. Cells that no ray can be in count too.
template <class Sample>
double agreement(const AdaptiveModel& model, const Sample& sample, const Support& about, const TreeBox& box) {
  constexpr std::size_t kCells = 4, kRays = 400000, kPoints = 400000;
  const auto cell_of = [&](const std::array<double, 4>& c) {
    std::size_t cell = 0;
    for (std::size_t d = 0; d < 4; ++d) {
      const double t = (c[d] - box.low[d]) / box.width(d);
      if (!(t >= 0.0 && t < 1.0)) return kCells * kCells * kCells * kCells;
      cell = cell * kCells + static_cast<std::size_t>(t * kCells);
    }
    return cell;
  };
  std::vector<double> found(kCells * kCells * kCells * kCells + 1, 0.0), expected(found.size(), 0.0);
  const Sequence even(SequenceKind::sobol, 6);
  double inside = 0.0;
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    const auto u = even.point<4>(i);
    ChartPoint p;
    for (std::size_t d = 0; d < 4; ++d) p.c[d] = box.low[d] + u[d] * box.width(d);
    const double e = model.pdf_etendue(about.from_chart(p)) * box.volume() * kRays / kPoints;
    expected[cell_of(p.c)] += e;
    inside += e;
  }
  expected.back() = std::max(0.0, kRays - inside);
  for (std::uint64_t i = 0; i < kRays; ++i) {
    const auto p = about.to_chart(sample(Sequence(SequenceKind::random, 8).point<4>(i)));
    found[p && p->chart == 0 ? cell_of(p->c) : found.size() - 1] += 1.0;
  }
  // The expectation is an integral by points: pool what is thin, where its own noise would count.
  double thin_found = 0.0, thin_expected = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (expected[i] >= 100.0) continue;
    thin_found += found[i], thin_expected += expected[i];
    found[i] = expected[i] = 0.0;
  }
  found.push_back(thin_found);
  expected.push_back(thin_expected);
  return test::chi_square_p(found, expected);
}

TEST(AdaptiveModelStatistical, SamplesAgreeWithTheDensity) {
  for (const AdaptiveData& data : {small_data(), dome_data()}) {
    const AdaptiveModel model(data);
    Support about;
    about.map = PolarMap::concentric;
    const TreeBox box{{-1.2, -1.2, -1, -std::numbers::pi}, {1.2, 1.2, 1, std::numbers::pi}};
    EXPECT_GT(agreement(
                  model, [&](const auto& u) { return model.sample(u); }, about, box),
              test::kFalseAlarm);
    const auto wrong = [&](auto u) {
      u[0] = u[0] * u[0];
      return model.sample(u);
    };
    EXPECT_LT(agreement(model, wrong, about, box), test::kFalseAlarm);
  }
}

TEST(AdaptiveModel, DensitiesOfDegenerateSourcesAreNamed) {
  const auto point = compress_adaptive(drawn_on(EmitterKind::point, 20000), {});
  EXPECT_FALSE(point->has_etendue());
  EXPECT_THROW(point->pdf_etendue({{}, Direction()}), InputError);
  EXPECT_THROW(point->pdf_area({}), InputError);
  EXPECT_NEAR(point->pdf_solid_angle({}, Direction()), 0.25 / std::numbers::pi, 0.01);
  const RayBlock rays = draw_rays(*point, Sequence(SequenceKind::random, 1), 1000);
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_LT(length(rays.origin_mm(i)), 1e-4);
}

TEST(AdaptiveModel, RectanglesHaveTheirClosedForms) {
  const auto model = compress_adaptive(drawn_on(EmitterKind::rectangle, 50000), {});
  const double radiance = 1.0 / std::numbers::pi;  // of flux 1 on 1 mm^2
  EXPECT_NEAR(model->pdf_etendue({{0.1, 0.2, 0.0}, Direction::from({0.3, 0, 1})}), radiance, 0.02 * radiance);
  EXPECT_EQ(model->pdf_etendue({{0.7, 0.2, 0.0}, Direction()}), 0.0);
  EXPECT_NEAR(model->pdf_area({0.1, 0.2, 0.0}), 1.0, 0.03);
  EXPECT_EQ(model->pdf_area({0.1, 0.2, 0.4}), 0.0);
  EXPECT_NEAR(model->pdf_solid_angle({0.1, 0.2, 0.0}, Direction()), radiance, 0.03 * radiance);
}

}  // namespace
}  // namespace lucerna
