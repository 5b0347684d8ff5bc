// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_colours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/material.h"
#include "lucerna/rayset/data/luminous_spectrum.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/engines/ray_paths.h"

namespace lucerna {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The lines F, d and C.
constexpr std::array<float, 3> kLines_nm{486.13F, 587.56F, 656.27F};
/// Angle of incidence on the left face of the prism, near that of least deviation.
constexpr double kIncidence_deg = 49.3;

/// A prism of 60 degrees along y, apex up, of N-BK7.
Solid prism() {
  auto mesh = std::make_shared<Mesh>();
  const double height = 10.0 * std::sqrt(3.0);
  for (const double y : {-1.0, 7.0})
    for (const auto& [x, z] : {std::pair{-10.0, 0.0}, {10.0, 0.0}, {0.0, height}})
      mesh->vertices_mm.push_back({x, y, z});
  mesh->triangles = {{0, 1, 2}, {3, 5, 4}, {0, 4, 1}, {0, 3, 4}, {1, 5, 2}, {1, 4, 5}, {2, 3, 0}, {2, 5, 3}};
  Solid solid;
  solid.mesh = mesh;
  solid.smooth_below_deg = 0.0;
  solid.refractive_index = refractive_index("bk7", kLines_nm[1]).n;
  solid.dispersion = std::make_shared<const Dispersion>(dispersion("bk7"));
  return solid;
}

/// 600 parallel rays beside each other on its left face, ray i at y = i / 100, of each line in turn.
std::shared_ptr<RaySet> three_lines() {
  auto set = std::make_shared<RaySet>();
  set->header.flux_lm = 1.0;
  set->header.columns = {{ColumnKind::wavelength_nm, "wavelength nm"}};
  set->rays.resize(600, 1);
  const double angle = radians(kIncidence_deg - 30.0);
  const Vec3 d{std::cos(angle), 0.0, std::sin(angle)};
  for (std::size_t i = 0; i < 600; ++i) {
    const Vec3 at = Vec3{-5.0, 0.01 * static_cast<double>(i), 5.0 * std::sqrt(3.0)} - 20.0 * d;
    set->rays.set(i, {at, Direction::from(d)});
    set->rays.weight[i] = 1.0F;
    set->rays.extra[0][i] = kLines_nm[i % 3];
  }
  return set;
}

Scene spectrometer() {
  Scene scene;
  scene.sources = {{std::make_shared<RaySetSource>(three_lines(), "lines"), Frame(), {}}};
  scene.solids = {prism()};
  scene.far_fields.emplace_back();
  scene.ray_detectors.emplace_back();
  return scene;
}

/// Where light of an index leaves the right face to, from the x axis upward.
double exit_angle(double index) {
  const double in = radians(kIncidence_deg), apex = radians(60.0);
  const double first = std::asin(std::sin(in) / index);
  const double out = std::asin(index * std::sin(apex - first));
  return radians(kIncidence_deg - 30.0) - (in + out - apex);
}

/// Rays that leave the right face as light of their line does, line by line, and those that leave near it in
/// another direction: some are reflected within and come out there after another round.
struct Exits {
  std::array<int, 3> of_line{};
  int others = 0;

  void add(const Direction& d, double y_mm) {
    const double angle = std::atan2(d.z(), d.x());
    if (std::abs(angle - exit_angle(1.5168)) > 0.03) return;
    const auto line = static_cast<std::size_t>(std::lround(100.0 * y_mm)) % 3;
    const double expected = exit_angle(refractive_index("bk7", static_cast<double>(kLines_nm[line])).n);
    ++(std::abs(angle - expected) < 1e-5 ? of_line[line] : others);
  }
};

TraceResult run_of(const Scene& scene, EngineKind engine, std::uint64_t from = 0, std::uint64_t to = 600) {
  TraceOptions options;
  options.first_ray = from;
  options.last_ray = to;
  options.engine = engine;
  return trace(scene, options);
}

TEST(RayColours, APrismPartsTheLinesAsSnellSays) {
  // The lines are 0.2 and 0.7 degrees apart: one index for all would be seen.
  EXPECT_GT(exit_angle(refractive_index("bk7", 656.27).n) - exit_angle(refractive_index("bk7", 486.13).n),
            0.012);
  const Scene scene = spectrometer();
  for (const EngineKind engine : {EngineKind::fast, EngineKind::reference}) {
    const TraceResult result = run_of(scene, engine);
    Exits exits;
    for (std::size_t i = 0; i < result.out_rays.size(); ++i) {
      const Ray ray = result.out_rays.ray(i);
      exits.add(ray.direction, ray.origin_mm.y);
    }
    for (const int n : exits.of_line) EXPECT_GT(n, 150) << "Fresnel lets nine tenths through";
    EXPECT_LT(exits.others, 12);
  }
}

TEST(RayColours, PathsTakeThatOfTheTrace) {
  Exits exits;
  for (const RayPath& path : ray_paths(spectrometer(), 600))
    exits.add(path.last_direction, path.points_mm.front().y);
  for (const int n : exits.of_line) EXPECT_GT(n, 150);
  EXPECT_LT(exits.others, 12);
}

TEST(RayColours, PartsOfARunAreTheWhole) {
  const Scene scene = spectrometer();
  const TraceResult whole = run_of(scene, EngineKind::fast);
  EXPECT_EQ(merge(run_of(scene, EngineKind::fast, 0, 123), run_of(scene, EngineKind::fast, 123, 600)), whole);
  Scene constant = scene;
  constant.solids[0].dispersion = nullptr;
  EXPECT_NE(run_of(constant, EngineKind::fast).out_rays, whole.out_rays);
}

// A wavelength of 0 is not known: the ray has the constant index, as all rays have without dispersion.
TEST(RayColours, UnknownWavelengthsHaveTheConstantIndex) {
  const auto set = three_lines();
  set->rays.extra[0].assign(600, 0.0F);
  Scene scene = spectrometer();
  scene.sources[0].rays = std::make_shared<RaySetSource>(set, "unknown");
  const TraceResult unknown = run_of(scene, EngineKind::fast);
  scene.solids[0].dispersion = nullptr;
  EXPECT_EQ(run_of(scene, EngineKind::fast).out_rays, unknown.out_rays);
}

TEST(RayColours, AbsorptionMayGoWithTheWavelength) {
  Scene scene = spectrometer();
  const double index = scene.solids[0].refractive_index;
  scene.solids[0].absorption_per_mm = 0.01;
  scene.solids[0].dispersion =
      std::make_shared<const Dispersion>(400.0, 700.0, std::vector{index, index}, std::vector{0.0, 0.0});
  EXPECT_EQ(ledger(run_of(scene, EngineKind::fast)).absorbed.back().second.mean, 0.0);
  scene.solids[0].dispersion = std::make_shared<const Dispersion>(400.0, 700.0, std::vector{index, index});
  EXPECT_GT(ledger(run_of(scene, EngineKind::fast)).absorbed.back().second.mean, 0.05) << "the constant one";
}

// Even power from 380 to 780 nm: the share of its lumens below 500 nm is 0.074, of its watts 0.3. 1e-6 false
// alarms at 4.9 sigma; the other unit's share is 270 sigma off.
TEST(RayColoursStatistical, LumensAreDrawnByTheirOwnSpectrum) {
  double below = 0.0, all = 0.0;
  for (double nm = 380.5; nm < 780.0; nm += 1.0) {
    all += luminous_efficiency(nm);
    if (nm < 500.0) below += luminous_efficiency(nm);
  }
  for (const FluxUnit unit : {FluxUnit::lumen, FluxUnit::watt}) {
    Scene scene = spectrometer();
    scene.sources[0].rays = make_emitter({.kind = EmitterKind::point, .flux_unit = unit});
    scene.sources[0].spectrum = {{380.0F, 780.0F}, {1.0F, 1.0F}};
    const RayColours colours(scene);
    ASSERT_TRUE(colours.are_needed());
    std::vector<float> nm(1'000'000);
    colours.emit(0, Sequence(SequenceKind::sobol, 5), 0, nm);
    const auto below_500 = std::ranges::count_if(nm, [](float w) { return w < 500.0F; });
    const double share = static_cast<double>(below_500) / 1e6;
    const double expected = unit == FluxUnit::lumen ? below / all : 0.3;
    EXPECT_NEAR(share, expected, 4.9 * std::sqrt(expected * (1.0 - expected) / 1e6));
  }
}

/// What `check` says of the scene.
std::string refusal(const Scene& scene) {
  try {
    check(scene);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(RayColours, SourcesMustKnowTheirWavelengths) {
  Scene scene = spectrometer();
  EXPECT_EQ(refusal(scene), "");
  scene.sources[0].rays = make_emitter({.kind = EmitterKind::point});
  EXPECT_THAT(refusal(scene), AllOf(HasSubstr("source 1: found no wavelengths"), HasSubstr("solid 'solid'")));
  scene.sources[0].spectrum = {{555.0F}, {1.0F}};
  EXPECT_EQ(refusal(scene), "");
  scene.sources[0].spectrum = {};
  scene.solids[0].dispersion = nullptr;
  EXPECT_EQ(refusal(scene), "");
  EXPECT_FALSE(RayColours(scene).are_needed());
}

TEST(RayColours, SpectraAreChecked) {
  Scene scene = spectrometer();
  auto& spectrum = scene.sources[0].spectrum;
  spectrum = {{500.0F, 400.0F}, {1.0F, 1.0F}};
  EXPECT_THAT(refusal(scene), HasSubstr("source 1: spectrum: found 400 nm after 500"));
  spectrum = {{400.0F, 500.0F}, {1.0F, -1.0F}};
  EXPECT_THAT(refusal(scene), HasSubstr("found a power of -1"));
  spectrum = {{400.0F, 500.0F}, {1.0F}};
  EXPECT_THAT(refusal(scene), HasSubstr("found 2 wavelengths and 1 powers"));
  spectrum = {{400.0F, 1e30F}, {1.0F, 1.0F}};
  EXPECT_THAT(refusal(scene), HasSubstr("found 1e+30 nm, expected 100 to 20000"));
  spectrum = {{400.0F, 500.0F}, {0.0F, 0.0F}};
  EXPECT_THAT(refusal(scene), HasSubstr("no power above 0"));
}

}  // namespace
}  // namespace lucerna
