// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/run/noise_rounds.h"

#include <algorithm>

#include "lucerna/trace/result/node_noise.h"

namespace lucerna {

std::uint64_t next_round(std::uint64_t rays) {
  std::uint64_t whole = kFirstRound;
  while (whole <= rays) {
    if (whole + whole / 2 > rays) return whole + whole / 2;
    whole *= 2;
  }
  return whole;
}

bool goes_by_noise(const Scene& scene) {
  return !scene.far_fields.empty() && scene.ray_detectors.empty() &&
         std::none_of(scene.sources.begin(), scene.sources.end(),
                      [](const PlacedSource& s) { return s.rays->ray_count().has_value(); });
}

NoiseEnd end_without_noise(const Scene& scene) {
  return !scene.far_fields.empty() && scene.ray_detectors.empty() ? NoiseEnd::finite_source
                                                                  : NoiseEnd::no_goal;
}

bool good_enough(const TraceResult& result, double node_noise, double goal) {
  return node_noise <= goal && !(peak_noise(result) > 0.5 * goal);
}

}  // namespace lucerna
