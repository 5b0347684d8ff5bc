// SPDX-License-Identifier: Apache-2.0
// Planes, luminance images and kept rays against what photometry says of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {
namespace {

PlacedSource emitter(const EmitterOptions& options, const Frame& world_from_source = {}) {
  return {make_emitter(options), world_from_source, std::nullopt};
}

TEST(Detector, FacingFramesAreRightHandedAndPutUpOnTop) {
  Rng rng(3, 0);
  for (int i = 0; i < 200; ++i) {
    const Direction normal = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    const Frame f = facing_frame(normal, {0, 0, 1}, {1, 2, 3});
    EXPECT_LT(length(cross(f.ex(), f.ey()) - f.ez()), 1e-12);
    EXPECT_LT(length(f.ez() - normal.vec()), 1e-12);
    EXPECT_GT(f.ey().z, 0.0) << "up in the world is up in the picture";
    EXPECT_LT(std::abs(f.ex().z), 1e-12) << "and the horizon is level";
  }
  // A floor and a ceiling have no up: +y takes its place.
  EXPECT_EQ(facing_frame(Direction(), {0, 0, 1}, {}), Frame());
  EXPECT_LT(length(facing_frame(-Direction(), {0, 0, 1}, {}).ey() - Vec3{0, 1, 0}), 1e-15);
  EXPECT_GT(length(facing_frame(Direction::from({0, 1, 0}), {0, 1, 0}, {}).ey()), 0.99);
}

TEST(Detector, EtendueOfAPupilIsThatOfTheIntegral) {
  LuminanceDetector d;
  d.grid = {Frame(), 200.0, 100.0, 4, 5};
  d.distance_mm = 300.0;
  d.pupil_radius_mm = 20.0;
  Rng rng(7, 0);
  for (const std::size_t cell : {std::size_t{0}, std::size_t{9}, std::size_t{19}}) {
    double sum = 0.0;
    const int n = 200'000;
    for (int i = 0; i < n; ++i) {
      const double x = d.grid.cell_x_mm(cell) + 50.0 * (rng.uniform() - 0.5);
      const double y = d.grid.cell_y_mm(cell) + 20.0 * (rng.uniform() - 0.5);
      const double r = 20.0 * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
      const double r2 = std::pow(x - r * std::cos(phi), 2) + std::pow(y - r * std::sin(phi), 2) + 9e4;
      sum += 9e4 / (r2 * r2);
    }
    const double exact = sum / n * 1000.0 * std::numbers::pi * 400.0;
    EXPECT_NEAR(etendue_mm2sr(d, cell), exact, 1.5e-3 * exact) << cell;
  }
  d.distance_mm = 1e7;  // from afar both kinds are one
  LuminanceDetector afar = d;
  afar.distance_mm = 0.0;
  afar.half_angle_deg = degrees(std::asin(20.0 / 1e7));
  EXPECT_NEAR(etendue_mm2sr(d, 9), etendue_mm2sr(afar, 9), 1e-6 * etendue_mm2sr(afar, 9));
}

// A point of I = flux / 4 pi lights a plane at distance d, tilted by a, with I cos(a + b) / r^2.
TEST(DetectorStatistical, IlluminanceFollowsTheInverseSquareLaw) {
  Scene scene;
  scene.sources = {emitter({.kind = EmitterKind::point, .flux = 4.0 * std::numbers::pi})};  // 1 cd
  const double tilt = radians(30.0);
  for (const double distance : {500.0, 1000.0, 2000.0}) {
    const Direction normal = Direction::from({std::sin(tilt), 0.0, -std::cos(tilt)});
    scene.planes.push_back({fmt::format("{}", distance),
                            {facing_frame(normal, {0, 0, 1}, {0, 0, distance}), distance, distance, 5, 5}});
  }
  const TraceResult result =
      trace(scene, {.last_ray = 1'000'000, .sequence = SequenceKind::random, .cells = 8});
  for (std::size_t p = 0; p < 3; ++p) {
    const PlaneImage image = illuminance(result, p);
    const Frame& frame = image.grid.world_from_plane;
    double chi2 = 0.0, without_cosine = 0.0;
    for (std::size_t i = 0; i < image.value.size(); ++i) {
      // The cell's mean by 16 x 16 points.
      double lx = 0.0, plain = 0.0;
      for (int k = 0; k < 256; ++k) {
        const double cell = image.grid.size_x_mm / 5.0;
        const Vec3 at = frame.point({image.grid.cell_x_mm(i) + cell * ((k % 16 + 0.5) / 16.0 - 0.5),
                                     image.grid.cell_y_mm(i) + cell * ((k / 16 + 0.5) / 16.0 - 0.5), 0.0});
        const double r2 = 1e-6 * dot(at, at);
        lx += -dot(at, frame.ez()) / length(at) / r2 / 256.0;
        plain += 1.0 / r2 / 256.0;
      }
      chi2 += std::pow((image.value[i] - lx) / image.standard_error[i], 2);
      without_cosine += std::pow((image.value[i] - plain) / image.standard_error[i], 2);
    }
    // 25 cells with errors from 16 replicates: chi2 has mean 29 and is above 110 with less than 1e-6.
    EXPECT_LT(chi2, 110.0) << image.name;
    EXPECT_GT(without_cosine, 110.0) << "a plane that forgot its tilt is seen";
  }
}

/// A Lambertian disk of 1000 lm.
constexpr double kDiskRadius = 5.0;
double disk_luminance() {
  return 1000.0 / (std::numbers::pi * std::numbers::pi * kDiskRadius * kDiskRadius) * 1e6;
}

TEST(DetectorStatistical, ADiskIsAsBrightFromAPointAsFromAfar) {
  Scene scene;
  scene.sources = {emitter({.kind = EmitterKind::disk, .radius_mm = kDiskRadius, .flux = 1000.0})};
  const double lean = radians(40.0);
  const Direction to_eye = Direction::from({std::sin(lean), 0.0, std::cos(lean)});
  LuminanceDetector afar{"afar", {facing_frame(to_eye, {0, 0, 1}, {}), 20.0, 20.0, 10, 10}, 8.0};
  LuminanceDetector eye = afar;
  eye.name = "eye";
  eye.distance_mm = 100.0;
  eye.pupil_radius_mm = 15.0;
  scene.luminances = {afar, eye};
  const TraceResult result = trace(scene, {.last_ray = 1'000'000});
  for (std::size_t k = 0; k < 2; ++k) {
    const PlaneImage image = luminance(result, k);
    int inside = 0;
    for (std::size_t i = 0; i < image.value.size(); ++i) {
      const double x = image.grid.cell_x_mm(i), y = image.grid.cell_y_mm(i);
      // The disk appears as an ellipse, foreshortened upwards; cells wholly inside and outside are clear.
      const double edge = std::hypot(x, y / std::cos(lean));
      if (edge < kDiskRadius - 2.5) {
        EXPECT_NEAR(image.value[i], disk_luminance(), 0.04 * disk_luminance()) << image.name << ' ' << i;
        ++inside;
      }
      if (edge > kDiskRadius + 4.5) {
        EXPECT_EQ(image.value[i], 0.0) << image.name << ' ' << i;
      }
    }
    EXPECT_GE(inside, 4);
    const double sum = std::accumulate(image.value.begin(), image.value.end(), 0.0);
    const double area = std::numbers::pi * kDiskRadius * kDiskRadius * std::cos(lean);
    EXPECT_NEAR(sum * image.grid.cell_mm2(), area * disk_luminance(), 0.01 * area * disk_luminance());
  }
}

// Radiance is conserved: in a mirror the disk is as bright as itself times the reflectance, wherever the
// mirror images it to. A wrong etendue or a reflectance that is applied twice fails.
TEST(DetectorStatistical, AMirrorShowsTheDiskTimesItsReflectance) {
  // The disk at the focus shines into the mirror, which shows it to an observer on the axis.
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 40.0, 0.0, Aperture::circle(60.0));
  Scene scene;
  scene.sources = {emitter({.kind = EmitterKind::disk, .radius_mm = kDiskRadius, .flux = 1000.0},
                           Frame::from_axis(-Direction(), 0.0, {0, 0, 40}))};
  scene.reflectors = {{mirror, Frame(), Reflectance({{0.0, 0.7}, {90.0, 0.7}})}};
  // Seen along the axis the middle of the mirror is filled with the disk.
  scene.luminances = {{"axis", {Frame(), 40.0, 40.0, 5, 5}, 2.0}};
  for (const EngineKind engine : {EngineKind::fast, EngineKind::reference}) {
    const TraceResult result = trace(scene, {.last_ray = 1'000'000, .engine = engine, .cells = 256});
    const PlaneImage image = luminance(result, 0);
    for (std::size_t i = 0; i < image.value.size(); ++i) {
      EXPECT_NEAR(image.value[i], 0.7 * disk_luminance(),
                  5.0 * image.standard_error[i] + 0.01 * disk_luminance());
      EXPECT_LT(image.standard_error[i], 0.03 * disk_luminance());
    }
  }
}

TEST(Detector, KeptRaysOfRangesJoinToTheBitsOfOneRun) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(100.0);
  set->rays.resize(20'000, 0);
  make_emitter({.kind = EmitterKind::sphere})->emit(Sequence(SequenceKind::random, 1), 0, set->rays);
  std::fill(set->rays.weight.begin(), set->rays.weight.end(), 1.0F);
  Scene scene;
  scene.sources = {emitter({.kind = EmitterKind::cylinder, .flux = 200.0}),
                   {std::make_shared<RaySetSource>(set, "set"), {}, std::nullopt},
                   emitter({.kind = EmitterKind::disk, .flux = 77.0})};
  scene.reflectors = {{conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)),
                       Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15}), Reflectance(0.5)}};
  scene.ray_detectors = {{}};
  const auto part = [&](std::uint64_t first, std::uint64_t last) {
    return trace(scene, {.first_ray = first, .last_ray = last, .cells = 64});
  };
  const TraceResult whole = part(100, 1'200'000);
  // Cuts within a block of 512, within a row of blocks, and where a row ends.
  const TraceResult a = part(100, 1234), b = part(1234, 524'288), c = part(524'288, 1'200'000);
  const TraceResult sum = merge(c, merge(b, a));
  EXPECT_EQ(sum.replicates, whole.replicates);
  EXPECT_EQ(sum.out_runs, whole.out_runs);
  EXPECT_EQ(sum.out_rays, whole.out_rays);
  EXPECT_GT(whole.out_rays.size(), 1'000'000u);
}

TEST(Detector, RangesSayWhatIsMissingOrDouble) {
  Scene scene;
  scene.sources = {emitter({.kind = EmitterKind::point})};
  scene.far_fields = {{"far", 90.0, 30.0}};
  const auto part = [&](std::uint64_t first, std::uint64_t last) {
    return trace(scene, {.first_ray = first, .last_ray = last});
  };
  const auto fault = [](const TraceResult& a, const TraceResult& b) {
    try {
      merge(a, b);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(fault(part(200, 300), part(0, 100)).find("rays 100:200 are missing"), std::string::npos);
  EXPECT_NE(fault(part(0, 150), part(100, 300)).find("rays 100:150 are in both"), std::string::npos);
  EXPECT_NE(fault(part(0, 300), part(100, 200)).find("rays 100:200 are in both"), std::string::npos);
  EXPECT_EQ(fault(part(100, 200), part(0, 100)), "");
}

class TentFarField : public testing::Test {
 protected:
  static TraceResult run(std::uint64_t first, std::uint64_t last, EngineKind engine) {
    Scene scene;
    scene.sources = {emitter({.kind = EmitterKind::cylinder, .flux = 1000.0})};
    scene.reflectors = {{conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)),
                         Frame::from_axis(-Direction(), 0.0, {0, 0, 15}), Reflectance(0.9)}};
    scene.far_fields = {{"hard", 15.0, 5.0}, {"tent", 15.0, 5.0, true}};
    return trace(scene, {.first_ray = first, .last_ray = last, .engine = engine, .cells = 256});
  }
};

TEST(Detector, TentsDealEveryUnitToTheFourNeighbours) {
  FarFieldDetector d{"far", 30.0, 10.0, true};
  const FarFieldGrid grid(d);
  Rng rng(11, 0);
  for (int i = 0; i < 2000; ++i) {
    const double c = 360.0 * rng.uniform(), gamma = i % 5 == 0 ? (i % 2) * 180.0 : 180.0 * rng.uniform();
    std::vector<std::int64_t> bins(grid.size());
    const std::int64_t quanta = 1 + static_cast<std::int64_t>(rng.bits() % 100'000'000);
    grid.add_tent(direction_from_type_c({radians(c), radians(gamma)}), quanta, bins.data());
    EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), std::int64_t{0}), quanta);
    double mean_gamma = 0.0;
    for (std::size_t k = 0; k < bins.size(); ++k) {
      if (bins[k] == 0) continue;
      const double node_c = 30.0 * static_cast<double>(k / 19),
                   node_gamma = 10.0 * static_cast<double>(k % 19);
      EXPECT_LE(std::abs(node_gamma - gamma), 10.0 + 1e-9);
      if (gamma > 1.0 && gamma < 179.0) {
        EXPECT_LE(std::abs(std::remainder(node_c - c, 360.0)), 30.0 + 1e-9);
      }
      mean_gamma += node_gamma * static_cast<double>(bins[k]) / static_cast<double>(quanta);
    }
    EXPECT_NEAR(mean_gamma, gamma, 1e-6 + 30.0 / static_cast<double>(quanta)) << "tents keep the mean angle";
  }
}

TEST_F(TentFarField, BothEnginesAndRangesAgreeAndFluxIsWhole) {
  for (const EngineKind engine : {EngineKind::fast, EngineKind::reference}) {
    const TraceResult whole = run(0, 100'000, engine);
    EXPECT_EQ(merge(run(0, 33'333, engine), run(33'333, 100'000, engine)).replicates, whole.replicates);
    double hard = 0.0, tent = 0.0;
    for (const double x : far_field(whole, 0).flux) hard += x;
    for (const double x : far_field(whole, 1).flux) tent += x;
    EXPECT_NEAR(hard, tent, 1e-9 * hard);
  }
  const FarField a = far_field(run(0, 100'000, EngineKind::fast), 1),
                 b = far_field(run(0, 100'000, EngineKind::reference), 1);
  double moved = 0.0;
  for (std::size_t i = 0; i < a.flux.size(); ++i) moved += std::abs(a.flux[i] - b.flux[i]);
  EXPECT_LT(moved, 2e-3 * 1000.0);
}

}  // namespace
}  // namespace lucerna
