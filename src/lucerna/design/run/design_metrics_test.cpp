// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/source.h"
#include "lucerna/trace.h"

namespace lucerna {
namespace {

/// A disk that shines down, and what sees it.
Scene disk_alone() {
  Scene scene;
  scene.sources.push_back({make_emitter({.kind = EmitterKind::disk, .flux = 500.0}),
                           Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), std::nullopt});
  scene.far_fields.emplace_back();
  return scene;
}

// The mean over a degree about the axis, which it had been, is well below that.
TEST(DesignMetrics, TheTargetsAxisIsThatOneDirection) {
  DesignTarget target;
  IntensityDistribution& d = target.distribution;
  d.c_deg = {0.0};
  for (int g = 0; g <= 360; ++g) d.gamma_deg.push_back(0.5 * g);
  for (const double g : d.gamma_deg) d.cd.push_back(1000.0 * std::exp(-g * g));
  const Scene scene = disk_alone();
  TraceOptions options;
  options.last_ray = 1 << 15;
  const DesignMetrics found = design_metrics(target, 250.0, trace(scene, options), scene);
  EXPECT_EQ(found.target_factor, 2.0) << "500 lm over the scale of the error";
  ASSERT_TRUE(found.target_beam);
  EXPECT_EQ(found.target_beam->centre_cd, 2000.0);
  EXPECT_EQ(found.target_beam->peak.cd, 2000.0);
}

}  // namespace
}  // namespace lucerna
