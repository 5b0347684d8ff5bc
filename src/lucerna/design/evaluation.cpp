// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation.h"

#include <algorithm>
#include <array>
#include <variant>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/design/device_evaluator.h"
#include "lucerna/design/evaluation_sums.h"

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

EvaluationSums total(const std::vector<TaskSums>& tasks, std::size_t bins) {
  EvaluationSums sums;
  for (std::vector<double>& flux : sums.flux) flux.assign(bins, 0.0);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const TaskSums& task = tasks[t];
    std::vector<double>& stream = sums.flux[t % kDesignStreams];
    for (std::size_t b = 0; b < bins; ++b) stream[b] += task.flux[b];
    sums.weight += task.weight;
    sums.reflected += task.reflected;
    sums.direct += task.direct;
    sums.absorbed += task.absorbed;
    sums.back += task.back;
    sums.lost += task.lost;
  }
  return sums;
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
  const EvaluationSums all = total(sums, bins.size());
  Evaluation e = evaluation_of(all);
  e.rays = per_task * kDesignTasks * kBlockRays;
  if (options.derivatives) e.jacobian = fold_jacobians(jacobians, bins.size(), design, 1.0 / all.weight);
  return e;
}

}  // namespace

BinJacobian fold_jacobians(const std::vector<std::vector<double>>& parts, std::size_t bins,
                           const DesignShape& shape, double scale) {
  const std::vector<int>& parameter_of = shape.parameter_of();
  const std::size_t n = parameter_of.size();
  BinJacobian j =
      BinJacobian::Zero(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  parallel_blocks(bins, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      double* row = j.data() + b * shape.parameter_count();
      for (const std::vector<double>& part : parts) {
        for (std::size_t c = 0; c < n; ++c) row[parameter_of[c]] += scale * part[b * n + c];
      }
    }
  });
  return j;
}

Evaluation evaluation_of(const EvaluationSums& sums) {
  const std::size_t bins = sums.flux.front().size();
  Evaluation e;
  e.flux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins));
  e.variance = e.flux;
  // Streams are independent: the variance of their mean is that of their scatter over their number.
  constexpr auto kStreams = static_cast<double>(kDesignStreams);
  for (std::size_t b = 0; b < bins; ++b) {
    double sum = 0.0, squares = 0.0;
    for (const std::vector<double>& stream : sums.flux) sum += stream[b];
    for (const std::vector<double>& stream : sums.flux)
      squares += (stream[b] - sum / kStreams) * (stream[b] - sum / kStreams);
    e.flux[static_cast<Eigen::Index>(b)] = sum / sums.weight;
    e.variance[static_cast<Eigen::Index>(b)] =
        squares * kStreams / (kStreams - 1.0) / (sums.weight * sums.weight);
  }
  e.reflected = sums.reflected / sums.weight;
  e.direct = sums.direct / sums.weight;
  e.absorbed = sums.absorbed / sums.weight;
  e.back = sums.back / sums.weight;
  e.lost = sums.lost / sums.weight;
  return e;
}

Evaluation evaluate(const DesignShape& shape, const Reflectance& reflectance, const DesignRays& rays,
                    const TentBins& bins, const EvaluationOptions& options) {
  LUCERNA_CHECK(options.rays <= rays.size() && options.rays >= kDesignTasks * kBlockRays, "{} rays of {}",
                options.rays, rays.size());
  if (DeviceEvaluator* const device = rays.device()) {
    return device->evaluate(shape, reflectance, rays, bins, options);
  }
  return std::visit(
      [&](const auto& s) { return evaluate_family(shape, s, reflectance, rays, bins, options); },
      shape.family());
}

}  // namespace lucerna
