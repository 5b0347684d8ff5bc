// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation.h"

#include <algorithm>
#include <array>
#include <variant>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/design/evaluation_kernel.h"

namespace lucerna {

namespace {

/// Sums of the rays of one task.
struct TaskSums {
  std::vector<double> flux;
  double weight = 0.0, reflected = 0.0, direct = 0.0, absorbed = 0.0, back = 0.0, lost = 0.0;
  /// Bins x coefficients, row by row; null without derivatives.
  double* jacobian = nullptr;
  std::size_t coefficients = 0;

  void ended(PathEnd end, double kept, double taken) {
    absorbed += taken;
    (end == PathEnd::direct      ? direct
     : end == PathEnd::reflected ? reflected
     : end == PathEnd::back      ? back
                                 : lost) += kept;
  }
  void add(int bin, double x) { flux[static_cast<std::size_t>(bin)] += x; }
  struct Row {
    double* at;
    void add(int coefficient, double x) const { at[coefficient] += x; }
  };
  Row row(int bin) const { return {jacobian + static_cast<std::size_t>(bin) * coefficients}; }
};

template <class View>
void trace_block(const EvaluationView<View>& view, const DesignRays::Block& block, TaskSums& sums) {
  Path<View> path;
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const double weight = block.weight[i];
    sums.weight += weight;
    view.trace({block.x_mm[i], block.y_mm[i], block.z_mm[i]}, {block.kx[i], block.ky[i], block.kz[i]}, weight,
               path, sums);
  }
}

/// Jacobians that are summed apart: by the number of rays alone, so that the sums never depend on threads.
/// Each is as large as the result, so few rays get few.
std::size_t jacobian_groups(std::uint64_t rays) {
  std::size_t groups = 2;
  while (groups < kDesignTasks && rays / groups > (1u << 17)) groups *= 2;
  return groups;
}

/// Adds the groups in their order and the coefficients that are one parameter.
BinJacobian fold(const std::vector<std::vector<double>>& groups, std::size_t bins, const DesignShape& shape,
                 double scale) {
  const std::vector<int>& parameter_of = shape.parameter_of();
  const std::size_t n = parameter_of.size();
  BinJacobian j =
      BinJacobian::Zero(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  parallel_blocks(bins, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      double* row = j.data() + b * shape.parameter_count();
      for (const std::vector<double>& group : groups) {
        for (std::size_t c = 0; c < n; ++c) row[parameter_of[c]] += scale * group[b * n + c];
      }
    }
  });
  return j;
}

Evaluation summarise(const std::vector<TaskSums>& sums, std::size_t bins) {
  Evaluation e;
  double weight = 0.0;
  for (const TaskSums& s : sums) weight += s.weight;
  e.flux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins));
  e.variance = e.flux;
  // Streams are independent: the variance of their mean is that of their scatter over their number.
  constexpr auto kStreams = static_cast<double>(kDesignStreams);
  for (std::size_t b = 0; b < bins; ++b) {
    std::array<double, kDesignStreams> stream{};
    for (std::size_t t = 0; t < sums.size(); ++t) stream[t % kDesignStreams] += sums[t].flux[b];
    double sum = 0.0, squares = 0.0;
    for (const double x : stream) sum += x;
    for (const double x : stream) squares += (x - sum / kStreams) * (x - sum / kStreams);
    e.flux[static_cast<Eigen::Index>(b)] = sum / weight;
    e.variance[static_cast<Eigen::Index>(b)] = squares * kStreams / (kStreams - 1.0) / (weight * weight);
  }
  for (const TaskSums& s : sums) {
    e.reflected += s.reflected / weight;
    e.direct += s.direct / weight;
    e.absorbed += s.absorbed / weight;
    e.back += s.back / weight;
    e.lost += s.lost / weight;
  }
  return e;
}

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

template <class Shape>
Evaluation evaluate_family(const DesignShape& design, const Shape& shape, const Reflectance& reflectance,
                           const DesignRays& rays, const TentBins& bins, const EvaluationOptions& options) {
  const std::uint64_t per_task = options.rays / kBlockRays / kDesignTasks;
  const auto view = evaluation_view(shape, design.aperture(), reflectance, bins, options);
  const std::size_t groups = jacobian_groups(options.rays);
  std::vector<std::vector<double>> jacobians(options.derivatives ? groups : 0);
  std::vector<TaskSums> sums(kDesignTasks);
  parallel_blocks(options.derivatives ? groups : kDesignTasks, 1, [&](std::size_t group, std::size_t) {
    const std::size_t each = options.derivatives ? kDesignTasks / groups : 1;
    const std::size_t coefficients = shape.coefficients().size();
    if (options.derivatives) jacobians[group].assign(bins.size() * coefficients, 0.0);
    for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
      sums[r].flux.assign(bins.size(), 0.0);
      if (options.derivatives) sums[r].jacobian = jacobians[group].data();
      sums[r].coefficients = coefficients;
      for (std::uint64_t b = 0; b < per_task; ++b) {
        trace_block(view, rays.block(b * kDesignTasks + r), sums[r]);
      }
    }
  });
  Evaluation e = summarise(sums, bins.size());
  e.rays = per_task * kDesignTasks * kBlockRays;
  if (options.derivatives) {
    double weight = 0.0;
    for (const TaskSums& s : sums) weight += s.weight;
    e.jacobian = fold(jacobians, bins.size(), design, 1.0 / weight);
  }
  return e;
}

}  // namespace

Evaluation evaluate(const DesignShape& shape, const Reflectance& reflectance, const DesignRays& rays,
                    const TentBins& bins, const EvaluationOptions& options) {
  LUCERNA_CHECK(options.rays <= rays.size() && options.rays >= kDesignTasks * kBlockRays, "{} rays of {}",
                options.rays, rays.size());
  return std::visit(
      [&](const auto& s) { return evaluate_family(shape, s, reflectance, rays, bins, options); },
      shape.family());
}

}  // namespace lucerna
