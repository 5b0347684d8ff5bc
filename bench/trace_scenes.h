// SPDX-License-Identifier: Apache-2.0
#pragma once

// The scenes that light tracing is measured on, by the names that benchmarks of other back ends use.

#include <memory>
#include <utility>

#include "lucerna/bounding_surface.h"
#include "lucerna/trace/benchmark/benchmark.h"

namespace bench {

using namespace lucerna;
using Case = BenchmarkScene;
inline const std::span<const Case> kCases = benchmark_scenes();

inline std::shared_ptr<const RaySet> cylinder(std::size_t n) { return benchmark_rays(n); }
inline Scene scene_of(const Case& c, std::shared_ptr<const RaySet> rays) {
  return benchmark_scene(c, std::move(rays));
}

}  // namespace bench
