// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/result_remarks.h"

#include <fmt/format.h>

#include <cmath>

#include "lucerna/design/validation/box_error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

std::optional<std::string> noise_remark(const DesignError& error) {
  const BoxErrorEstimate& e = error.c48;
  if (!(e.excess <= 2.0 * e.standard_error)) return std::nullopt;
  return fmt::format("no error is left that {:.3g} M rays can distinguish from noise: {:.2f} +- {:.2f} %",
                     1e-6 * static_cast<double>(error.rays), 100.0 * e.excess, 100.0 * e.standard_error);
}

std::optional<std::string> no_step_remark(const DesignFindings& result) {
  if (result.evaluations > 0 || result.end == DesignTermination::converged) return std::nullopt;
  const BoxErrorEstimate &found = result.error.c48, &began = result.start_error.c48;
  const double noise = std::hypot(found.standard_error, began.standard_error);
  if (std::abs(found.excess - began.excess) > 4.0 * noise)
    return "the search ended before its first step: the result is the best of the shapes that it could begin "
           "with";
  return "nothing was designed: the search ended before its first step, and the result is what it began with";
}

std::optional<std::string> rings_remark(const DesignTarget& target, const DesignError& error) {
  if (target.plane || target.zones_only) return std::nullopt;
  IntensityDistribution rings = target.distribution;
  const std::vector<double> means = ring_means(rings);
  for (std::size_t c = 0; c < rings.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < means.size(); ++g) rings.at(c, g) = means[g];
  }
  const double off = box_error({target.distribution}, {rings}, TargetMode::shape).c48.excess;
  if (!(off > 0.5 * error.c48.excess)) return std::nullopt;
  return fmt::format(
      "the target's own mean over its C planes is {:.1f} % off the target, and a mirror of revolution makes "
      "all planes alike; a free form need not",
      100.0 * off);
}

}  // namespace lucerna
