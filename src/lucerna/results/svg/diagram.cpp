// SPDX-License-Identifier: Apache-2.0
#include "lucerna/diagram.h"

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/svg_polar.h"

namespace lucerna {

std::string polar_diagram(const IntensityDistribution& distribution,
                          std::span<const double> standard_error_cd, const std::string& title) {
  if (!standard_error_cd.empty() && standard_error_cd.size() != distribution.cd.size())
    throw InputError(fmt::format("standard errors: found {} numbers, expected {}", standard_error_cd.size(),
                                 distribution.cd.size()));
  PolarOptions options;
  options.title = title;
  options.standard_error = standard_error_cd;
  return polar_svg(distribution, options);
}

}  // namespace lucerna
