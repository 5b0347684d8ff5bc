// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

TEST(WavelengthTable, LinesStayLines) {
  const std::vector<float> nm{600, 450, 450, 550, 600, 450}, weight{1, 2, 1, 2, 3, 1};
  const WavelengthTable table = wavelength_table(nm, weight);
  double of450 = 0.0, of550 = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const float x = table.at((i + 0.5) / 1000.0);
    ASSERT_TRUE(x == 450.0f || x == 550.0f || x == 600.0f) << x;
    of450 += x == 450.0f ? 0.001 : 0.0, of550 += x == 550.0f ? 0.001 : 0.0;
  }
  EXPECT_NEAR(of450, 0.4, 0.002);
  EXPECT_NEAR(of550, 0.2, 0.002);
  EXPECT_EQ(table.at(0.0), 450.0f);
  EXPECT_EQ(wavelength_table(std::vector<float>{500}, std::vector<float>{2}).at(0.7), 500.0f);
}

TEST(WavelengthTable, SpectraAreQuantilesOfTheFlux) {
  std::vector<float> nm, weight;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Rng rng(1, i);
    const double u = rng.uniform();
    nm.push_back(static_cast<float>(400.0 + 300.0 * u));
    weight.push_back(static_cast<float>(2.0 * u));  // density rises from 0
  }
  const WavelengthTable table = wavelength_table(nm, weight);
  EXPECT_LT(table.nm.size(), 100u);
  for (const double u : {0.05, 0.25, 0.5, 0.9})
    EXPECT_NEAR(table.at(u), 400.0 + 300.0 * std::sqrt(u), 4.0) << u;
}

/// A square, its left half blue and its right half red, or colours that know nothing of the place.
RaySet coloured(bool by_place, std::size_t n) {
  EmitterOptions options;
  options.kind = EmitterKind::rectangle;
  RaySet set;
  set.rays = draw_rays(*make_emitter(options), Sequence(SequenceKind::random, 3), n);
  set.header.set_flux(10.0);
  set.header.columns = {{ColumnKind::additional, "noise"},
                        {ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  set.rays.extra.assign(2, std::vector<float>(n, 0.0f));
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(5, i);
    const double u = rng.uniform();
    const bool red = by_place ? set.rays.x_mm[i] > 0.0f : rng.uniform() < 0.5;
    set.rays.extra[1][i] = static_cast<float>((red ? 620.0 : 450.0) + 20.0 * u);
  }
  return set;
}

/// Shares of red among rays from the left and the right half.
std::array<double, 2> red_by_side(const RayBlock& rays, const std::vector<float>& nm) {
  std::array<double, 2> red{}, all{};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t side = rays.x_mm[i] > 0.0f ? 1 : 0;
    all[side] += 1.0;
    red[side] += nm[i] > 540.0f ? 1.0 : 0.0;
    EXPECT_TRUE((nm[i] >= 450.0f && nm[i] <= 470.0f) || (nm[i] >= 620.0f && nm[i] <= 640.0f) ||
                nm[i] > 400.0f);
  }
  return {red[0] / all[0], red[1] / all[1]};
}

TEST(Wavelengths, HangTogetherWithThePlaceWhereTheyDidInTheFile) {
  const auto model = compress_adaptive(coloured(true, 20000), {});
  EXPECT_GT(model->data().wavelengths.size(), 1u);
  const Sequence sequence(SequenceKind::sobol, 1);
  const RayBlock rays = draw_rays(*model, sequence, 20000);
  std::vector<float> nm(rays.size());
  model->emit_wavelengths(sequence, 0, nm);
  const auto red = red_by_side(rays, nm);
  EXPECT_LT(red[0], 0.02);
  EXPECT_GT(red[1], 0.98);
  // In pieces the same.
  std::vector<float> piece(100);
  model->emit_wavelengths(sequence, 777, piece);
  for (std::size_t i = 0; i < piece.size(); ++i) EXPECT_EQ(piece[i], nm[777 + i]);
}

TEST(Wavelengths, AreOneSpectrumWhereTheyKnowNothingOfTheRay) {
  const auto model = compress_adaptive(coloured(false, 20000), {});
  EXPECT_EQ(model->data().wavelengths.size(), 1u);
  EXPECT_EQ(model->data().layers.size(), 1u);
}

TEST(Wavelengths, GoFromFileThroughModelToFile) {
  const test::TempDir folder;
  const RaySet set = coloured(true, 20000);
  const auto source = folder.path() / "in.tm25ray", copy = folder.path() / "out.tm25ray";
  write_ray_set(source, set, "tm25");
  save_source_model(folder.path() / "model.nfl", *compress_adaptive(read_ray_set(source), {}));
  const auto model = load_source_model(folder.path() / "model.nfl");
  ASSERT_TRUE(model->has_wavelengths());
  RaySetHeader header;
  header.set_flux(model->flux());
  header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  draw_rays(*model, Sequence(SequenceKind::random, 1), 20000, *create_ray_file(copy, "tm25", header, 20000));
  const RaySet back = read_ray_set(copy);
  ASSERT_EQ(back.rays.extra.size(), 1u);
  const auto red = red_by_side(back.rays, back.rays.extra[0]);
  EXPECT_LT(red[0], 0.02);
  EXPECT_GT(red[1], 0.98);
}

}  // namespace
}  // namespace lucerna
