// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/evaluation/evaluation_kernel.h"

namespace lucerna {

/// Sums over the rays of an evaluation, wherever they were traced: flux of each stream in each bin, and the
/// light of each end of a path, in mean rays.
struct EvaluationSums {
  std::array<std::vector<double>, kDesignStreams> flux;
  double weight = 0.0, reflected = 0.0, direct = 0.0, absorbed = 0.0, back = 0.0, lost = 0.0, bodies = 0.0;
};

/// Shares of the sources' flux, and the bins' variance from the scatter of the streams.
Evaluation evaluation_of(const EvaluationSums& sums);

/// Adds Jacobians of bins x coefficients in their order, and the coefficients that are one parameter.
BinJacobian fold_jacobians(const std::vector<std::vector<double>>& parts, std::size_t bins,
                           const DesignShape& shape, double scale);

/// A view of `shape` (of one of the families), the bins and what the options ask for, for tracing on the CPU.
template <class Shape>
auto evaluation_view(const Shape& shape, const Aperture& aperture, const Reflectance& reflectance,
                     const TentBins& bins, const EvaluationOptions& options) {
  const auto& table = reflectance.table();
  return EvaluationView<decltype(shape.view())>{
      shape.view(),         aperture,
      table.data(),         static_cast<std::uint32_t>(table.size()),
      bins.view(),          options.derivatives,
      options.direct_light, options.rim_mm};
}

}  // namespace lucerna
