// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/trace.h"
#include "lucerna/trace/benchmark/benchmark.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {
namespace {

// The baseline does the same work: light goes where the tracer that is measured against it sends it.
TEST(EmbreeBaseline, SendsLightWhereTheTracerDoes) {
  if (!EmbreeBaseline::available()) GTEST_SKIP() << "built without Embree";
  const auto rays = benchmark_rays(40000);
  for (const BenchmarkScene& s : benchmark_scenes()) {
    const Scene scene = benchmark_scene(s, rays);
    const HeightField field(scene.reflectors[0].reflector, 256);
    std::vector<double> bins(std::size_t{360} * 181);
    EmbreeBaseline(field).trace(rays->rays, s.focal_mm, kBenchmarkBounces, bins);
    TraceOptions options;
    options.last_ray = rays->rays.size();
    options.max_bounces = kBenchmarkBounces;
    options.cells = 256;
    const FarField ours = far_field(trace(scene, options), 0);
    ASSERT_EQ(ours.flux.size(), bins.size());
    const double all = std::accumulate(bins.begin(), bins.end(), 0.0);
    const double all_ours = std::accumulate(ours.flux.begin(), ours.flux.end(), 0.0);
    // Shares by rings of 30 degrees, and of the beam of 10.
    for (const int width : {30, 10}) {
      for (int first = width == 10 ? 170 : 0; first < 180; first += width) {
        double share = 0.0, share_ours = 0.0;
        for (std::size_t i = 0; i < bins.size(); ++i) {
          const int gamma = static_cast<int>(i % 181);
          if (gamma < first || gamma >= first + width + (first + width == 180)) continue;
          share += bins[i] / all;
          share_ours += ours.flux[i] / all_ours;
        }
        EXPECT_NEAR(share, share_ours, 0.02) << s.name << ", from " << first << " degrees";
      }
    }
  }
}

}  // namespace
}  // namespace lucerna
