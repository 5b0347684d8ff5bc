// SPDX-License-Identifier: Apache-2.0
// On a machine with a CUDA device: ctest -L gpu, or scripts/gpu_check.sh.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "lucerna/optics/shapes/spline_surface.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/trace/device/device_scene.h"
#include "lucerna/trace/device/device_trace.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "tests/support/device_scenes.h"

namespace lucerna {
namespace {

using test::compare_rays, test::cylinder, test::expect_closed, test::expect_same, test::RayPairs,
    test::rays_of, test::scene_of;

class DeviceTraceGpu : public testing::Test {
 protected:
  void SetUp() override {
    devices_ = cuda_accelerators();
    if (devices_.empty()) GTEST_SKIP() << cuda_unavailable_reason();
    RecordProperty("device", devices_.front()->name());
  }
  /// Ten million rays of a scene on the CPU and here.
  RayPairs compare(const Scene& scene, const std::string& name, int max_bounces = 100) const {
    const TraceOptions options{.last_ray = 10000000, .max_bounces = max_bounces};
    const TraceResult device = trace_on(devices_, scene, options);
    expect_closed(device);
    const RayPairs p = compare_rays(trace(scene, options), device);
    EXPECT_GT(p.rays, 1000000u) << name;
    std::printf("%s: %zu rays, %zu differ, others by at most %.2g mm and %.2g in direction\n", name.c_str(),
                p.rays, p.differ, p.max_mm, p.max_direction);
    return p;
  }
  Accelerators devices_;
};

TEST_F(DeviceTraceGpu, AgreesRayByRayWithTheCpuOnTenMillionRaysOfEveryFamily) {
  std::vector<Reflector> families = test::families();
  Rng rng(4, 0);
  std::vector<double> c(std::size_t{14} * 12);
  for (double& x : c) x = 2.0 * rng.uniform();
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(90.0, 70.0));
  families.push_back(
      {std::make_shared<SplineSurface>(Rectangle{-45.0, 45.0, -35.0, 35.0}, 14, 12, c, base.surface),
       Aperture::rectangle(90.0, 70.0)});
  std::size_t number = 0;
  for (const Reflector& family : families) {
    const Scene scene = scene_of(cylinder(), family);
    const RayPairs p = compare(scene, fmt::format("family {}", number++));
    EXPECT_LE(static_cast<double>(p.differ), 1e-5 * static_cast<double>(p.rays));
  }
}

// Swept curves and facets; the bound is for rays that were reflected once. Further reflections in hollow
// mirrors let a last digit grow.
TEST_F(DeviceTraceGpu, AgreesRayByRayOffExactMirrors) {
  std::size_t number = 0;
  for (const Reflector& family : test::exact_families()) {
    const Scene scene = scene_of(cylinder(), family);
    const RayPairs once = compare(scene, fmt::format("exact family {}, one reflection", number), 1),
                   often = compare(scene, fmt::format("exact family {}", number), 5);
    EXPECT_LE(static_cast<double>(once.differ), 1e-5 * static_cast<double>(once.rays));
    EXPECT_LE(static_cast<double>(often.differ), 0.02 * static_cast<double>(often.rays));
    ++number;
  }
}

// Which way light takes at a glass hangs on Fresnel's formulas and logarithms, whose last digits may differ.
TEST_F(DeviceTraceGpu, AgreesRayByRayBehindCoverGlasses) {
  const Scene scene = test::with_glasses(scene_of(cylinder()));
  const RayPairs p = compare(scene, "cover glasses", 2);
  EXPECT_LE(static_cast<double>(p.differ), 1e-3 * static_cast<double>(p.rays));
}

// Lobes and measured tables draw by cosines, logarithms and arc cosines, whose last digits may differ: then a
// direction that is nearly refused is taken, or another cell of a table.
TEST_F(DeviceTraceGpu, AgreesRayByRayOffMirrorsThatScatter) {
  const Scene plain = scene_of(cylinder());
  for (const auto& [scene, name] : {std::pair{test::with_lobes(plain), "lobes"},
                                    {test::with_table(plain, false), "a measured table"},
                                    {test::with_table(plain, true), "a table about the normal"}}) {
    const RayPairs p = compare(scene, name, 2);
    EXPECT_LE(static_cast<double>(p.differ), 1e-3 * static_cast<double>(p.rays)) << name;
  }
}

// Embree's float32 hits against the tree's in double: rays beside edges go on another triangle.
TEST_F(DeviceTraceGpu, AgreesRayByRayOffBodies) {
  const RayPairs p = compare(test::with_bodies(scene_of(cylinder())), "bodies", 2);
  EXPECT_LE(static_cast<double>(p.differ), 1e-3 * static_cast<double>(p.rays));
}

// The same tree walked by the same code on both: the stand-in's rays, sums and all.
TEST_F(DeviceTraceGpu, IsItsStandInOnScenesOfAllParts) {
  Accelerators stand_in;
  stand_in.push_back(make_emulated_accelerator());
  Scene scene = test::with_glasses(test::with_bodies(scene_of(cylinder(), test::exact_families().front())));
  scene.far_fields.push_back({"tents", 5.0, 1.0, true});
  const TraceOptions options{.last_ray = 300000, .max_bounces = 2};
  const TraceResult device = trace_on(devices_, scene, options);
  expect_same(device, trace_on(devices_, scene, options));
  const RayPairs p = compare_rays(trace_on(stand_in, scene, options), device);
  EXPECT_GT(p.rays, 50000u);
  EXPECT_LE(static_cast<double>(p.differ), 1e-3 * static_cast<double>(p.rays));
}

TEST_F(DeviceTraceGpu, HistogramsAreTheSameFromRunToRunAndForAnyRanges) {
  const Scene scene = scene_of(cylinder());
  const TraceOptions all{.last_ray = 3000000};
  const TraceResult once = trace_on(devices_, scene, all);
  expect_same(once, trace_on(devices_, scene, all));
  const TraceResult first = trace_on(devices_, scene, {.last_ray = 1234567});
  const TraceResult rest = trace_on(devices_, scene, {.first_ray = 1234567, .last_ray = 3000000});
  EXPECT_TRUE(merge(first, rest).replicates == once.replicates);
}

TEST_F(DeviceTraceGpu, ModelsAreSampledAsOnTheCpu) {
  const auto rays = rays_of(*make_emitter({.kind = EmitterKind::filament}), 100000);
  const std::vector<std::shared_ptr<const RaySource>> models{compress_adaptive(*rays, {}),
                                                             compress_clusters(*rays)};
  for (const auto& model : models) {
    const Scene scene = scene_of(model);
    const TraceOptions options{.last_ray = 4000000};
    const TraceResult cpu = trace(scene, options), device = trace_on(devices_, scene, options);
    const RayPairs p = compare_rays(cpu, device);
    EXPECT_LE(static_cast<double>(p.differ), 1e-3 * static_cast<double>(p.rays));
    // And as a whole: the chi-square of all cells, each against the spread between replicates, at 6 standard
    // deviations. The same rays were meant, so anything like independent samples would be far inside.
    const FarField a = far_field(cpu, 0), b = far_field(device, 0);
    double squares = 0.0, cells = 0.0;
    for (std::size_t i = 0; i < a.flux.size(); ++i) {
      const double error = std::hypot(a.standard_error[i], b.standard_error[i]);
      if (!(error > 0.0)) continue;
      squares += std::pow((a.flux[i] - b.flux[i]) / error, 2);
      cells += 1.0;
    }
    EXPECT_LT(squares, cells + 6.0 * std::sqrt(2.0 * cells));
  }
}

// Every kernel, mirror, detector and kind of source with few rays: what compute-sanitizer looks at.
TEST_F(DeviceTraceGpu, SmallSceneOfAllParts) {
  const auto rays = rays_of(*cylinder(), 6000);
  Scene plain = scene_of(std::make_shared<RaySetSource>(rays, "cylinder"));
  plain.sources.push_back({compress_adaptive(*rays, {}), {}, 100.0});
  plain.sources.push_back({compress_clusters(*rays), {}, 100.0});
  std::vector<Scene> scenes{plain};
  for (const Reflector& family : test::exact_families()) {
    scenes.push_back(plain);
    scenes.back().reflectors[0].reflector = family;
  }
  scenes.push_back(test::with_glasses(test::with_bodies(scenes.back())));
  scenes.back().far_fields.push_back({"tents", 5.0, 1.0, true});
  for (const Scene& scene : scenes) {
    const TraceResult device = trace_on(devices_, scene, {.last_ray = 20000, .cells = 64});
    expect_closed(device);
    std::uint64_t counted = 0;
    for (const Tally& t : device.replicates) counted += t.rays;
    EXPECT_EQ(counted, 20000u);
    EXPECT_FALSE(device.out_rays.empty());
  }
}

TEST_F(DeviceTraceGpu, TreesAreThoseOfTheHeightField) {
  const Scene scene = scene_of(cylinder());
  const TraceOptions options{.last_ray = 1000, .cells = 1024};
  DeviceScene device(*devices_.front(), scene, RayNumbering(scene.sources, 1), options);
  HeightField field(scene.reflectors[0].reflector, options.cells);
  for (FieldVertex& v : field.vertices()) v.z_mm *= 1.25F;
  field.rebuild();
  device.set_vertices(0, field.vertices());
  const std::vector<FieldNode> nodes = device.nodes(0);
  ASSERT_EQ(nodes.size(), field.nodes().size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    ASSERT_EQ(nodes[i].a, field.nodes()[i].a) << i;
    ASSERT_EQ(nodes[i].e, field.nodes()[i].e) << i;
  }
  EXPECT_EQ(device.band(0).low_mm, field.band().low_mm);
}

}  // namespace
}  // namespace lucerna
