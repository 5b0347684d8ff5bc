// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/cluster_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/source/cluster_compress.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/emitter.h"
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

/// Everything behind the checksum must hold on its own: random damage to the sections of a valid file, packed
/// again.
TEST(ClusterModelFuzz, DamagedSectionsAreRefusedOrHarmless) {
  const NflFile good = small_model(EmitterKind::disk, BoundingSurface::sphere(2.0))->to_nfl();
  int refused = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    NflFile bad = good;
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
      const auto model = ClusterModel::from_nfl(decode_nfl(encode_nfl(bad), "bad.nfl"), "bad.nfl");
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
