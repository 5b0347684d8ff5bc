// SPDX-License-Identifier: Apache-2.0
// On a machine with a CUDA device: ctest -L gpu, or scripts/gpu_check.sh.
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/reflector/spline_surface.h"
#include "lucerna/source/adaptive_compress.h"
#include "lucerna/source/cluster_compress.h"
#include "lucerna/source/ray_set_source.h"
#include "lucerna/trace/device_scene.h"
#include "lucerna/trace/device_trace.h"
#include "tests/support/device_scenes.h"

namespace lucerna {
namespace {

using test::compare_rays, test::cylinder, test::expect_same, test::RayPairs, test::rays_of, test::scene_of;

class DeviceTraceGpu : public testing::Test {
 protected:
  void SetUp() override {
    devices_ = cuda_accelerators();
    if (devices_.empty()) GTEST_SKIP() << why_no_cuda();
    RecordProperty("device", devices_.front()->name());
  }
  Accelerators devices_;
};

TEST_F(DeviceTraceGpu, AgreesRayByRayWithTheCpuOnTenMillionRaysOfEveryFamily) {
  std::vector<Reflector> families = test::families();
  Rng rng(4, 0);
  std::vector<double> c(14 * 12);
  for (double& x : c) x = 2.0 * rng.uniform();
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(90.0, 70.0));
  families.push_back(
      {std::make_shared<SplineSurface>(Rectangle{-45.0, 45.0, -35.0, 35.0}, 14, 12, c, base.surface),
       Aperture::rectangle(90.0, 70.0)});
  std::size_t number = 0;
  for (const Reflector& family : families) {
    const Scene scene = scene_of(cylinder(), family);
    const TraceOptions options{.last_ray = 10000000};
    const RayPairs p = compare_rays(trace(scene, options), trace_on(devices_, scene, options));
    EXPECT_GT(p.rays, 1000000u);
    EXPECT_LE(static_cast<double>(p.differ), 1e-5 * static_cast<double>(p.rays)) << "family " << number;
    std::printf("family %zu: %zu rays, %zu differ, others by at most %.2g mm and %.2g in direction\n", number,
                p.rays, p.differ, p.most_mm, p.most_direction);
    ++number;
  }
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

// Every kernel, detector and kind of source with few rays: what compute-sanitizer looks at.
TEST_F(DeviceTraceGpu, SmallSceneOfAllParts) {
  const auto rays = rays_of(*cylinder(), 6000);
  Scene scene = scene_of(std::make_shared<RaySetSource>(rays, "cylinder"));
  scene.sources.push_back({compress_adaptive(*rays, {}), {}, 100.0});
  scene.sources.push_back({compress_clusters(*rays), {}, 100.0});
  const TraceOptions options{.last_ray = 20000, .cells = 64};
  const TraceResult device = trace_on(devices_, scene, options);
  std::uint64_t counted = 0;
  for (const Tally& t : device.replicates) {
    counted += t.rays;
    EXPECT_EQ(t.emitted,
              t.out_direct + t.out_reflected + t.absorbed[0] + t.absorbed[1] + t.lost[0] + t.lost[1]);
  }
  EXPECT_EQ(counted, 20000u);
  EXPECT_FALSE(device.out_rays.empty());
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
