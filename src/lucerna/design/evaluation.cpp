// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation.h"

#include <algorithm>
#include <array>
#include <variant>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/design/smooth_path.h"

namespace lucerna {

namespace {

/// Sums of the rays of one task.
struct TaskSums {
  std::vector<double> flux;
  double weight = 0.0, reflected = 0.0, direct = 0.0, absorbed = 0.0, back = 0.0, lost = 0.0;
};

/// Traces blocks of rays into sums and, for the coefficients of the family, into a Jacobian.
template <class Shape>
class BlockTracer {
 public:
  BlockTracer(const Shape& shape, const Aperture& aperture, const Reflectance& reflectance,
              const TentBins& bins, const EvaluationOptions& options)
      : shape_(shape),
        aperture_(aperture),
        tracer_(shape, aperture),
        reflectance_(reflectance),
        bins_(bins),
        options_(options) {}

  /// `jacobian` (bins x coefficients, row by row) may be null.
  void trace(const DesignRays::Block& block, TaskSums& sums, double* jacobian) const {
    Path<Shape> path;
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const double weight = block.weight[i];
      sums.weight += weight;
      tracer_.trace({block.x_mm[i], block.y_mm[i], block.z_mm[i]}, {block.kx[i], block.ky[i], block.kz[i]},
                    path);
      const double kept = weight * reflected_share(path);
      sums.absorbed += weight - kept;
      switch (path.end) {
        case PathEnd::direct:
          sums.direct += kept;
          if (!options_.direct_light) continue;
          break;
        case PathEnd::reflected:
          sums.reflected += kept;
          break;
        case PathEnd::back:
          sums.back += kept;
          continue;
        case PathEnd::lost:
          sums.lost += kept;
          continue;
      }
      deposit(path, kept, sums, jacobian);
    }
  }

 private:
  double reflected_share(const Path<Shape>& path) const {
    double share = 1.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(path.hits); ++i) {
      const auto& hit = path.hit[i];
      share *= reflectance_.at(std::min(1.0, -hit.m / length(hit.g)));
    }
    return share;
  }

  void deposit(const Path<Shape>& path, double energy, TaskSums& sums, double* jacobian) const {
    TentBins::Deposit d;
    bins_.deposit(path.origin, path.direction, d);
    if (d.n == 0) return;
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
      sums.flux[static_cast<std::size_t>(d.bin[k])] += energy * d.weight[k];
    }
    if (jacobian == nullptr || path.hits == 0) return;
    std::array<HitAdjoint, kMostPathHits> by_u, by_v;
    const TentBins::Gradient in_u = bins_.gradient_u(path.origin, path.direction);
    path_adjoint(path, path.hits - 1, in_u.direction, in_u.origin, by_u.data());
    if (!bins_.is_rings()) {
      const TentBins::Gradient in_v = bins_.gradient_v(path.origin, path.direction);
      path_adjoint(path, path.hits - 1, in_v.direction, in_v.origin, by_v.data());
    }
    const std::size_t n = shape_.coefficients().size();
    for (std::size_t i = 0; i < static_cast<std::size_t>(path.hits); ++i) {
      std::array<double, Shape::kSupport> u, v{};
      const auto& local = path.hit[i].local;
      shape_.gradient(local, by_u[i].alpha, by_u[i].beta, by_u[i].gamma, u.data());
      if (!bins_.is_rings()) {
        shape_.gradient(local, by_v[i].alpha, by_v[i].beta, by_v[i].gamma, v.data());
      }
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        shape_.add(local, energy * d.du[k], u.data(), energy * d.dv[k], v.data(),
                   jacobian + static_cast<std::size_t>(d.bin[k]) * n);
      }
    }
    if (options_.rim_mm <= 0.0) return;
    for (int i = 0; i < path.hits; ++i) rim_term(path, i, energy, d, jacobian);
  }

  /// Light that the rim gains or loses as a hit moves: a strip of `rim_mm` inside it stands for the rim.
  void rim_term(const Path<Shape>& path, int last, double energy, const TentBins::Deposit& reflected,
                double* jacobian) const {
    const auto& hit = path.hit[static_cast<std::size_t>(last)];
    const RimDistance rim = rim_distance(aperture_, hit.x, hit.y);
    if (!(rim.inside_mm < options_.rim_mm)) return;
    std::array<HitAdjoint, kMostPathHits> by_place;
    path_adjoint(path, last, {}, rim.gradient, by_place.data());
    TentBins::Deposit missed;
    if (last > 0 || options_.direct_light) {
      bins_.deposit({hit.x, hit.y, smooth_point(shape_, hit.x, hit.y).z_mm}, hit.d, missed);
    }
    const std::size_t n = shape_.coefficients().size();
    const double density = energy / options_.rim_mm;
    const std::array<double, Shape::kSupport> none{};
    for (int i = 0; i <= last; ++i) {
      const auto& local = path.hit[static_cast<std::size_t>(i)].local;
      const HitAdjoint& by = by_place[static_cast<std::size_t>(i)];
      std::array<double, Shape::kSupport> place;
      shape_.gradient(local, by.alpha, by.beta, by.gamma, place.data());
      const auto add = [&](const TentBins::Deposit& to, double sign) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(to.n); ++k) {
          shape_.add(local, sign * density * to.weight[k], place.data(), 0.0, none.data(),
                     jacobian + static_cast<std::size_t>(to.bin[k]) * n);
        }
      };
      add(reflected, 1.0);
      add(missed, -1.0);
    }
  }

  const Shape& shape_;
  const Aperture& aperture_;
  SmoothTracer<Shape> tracer_;
  const Reflectance& reflectance_;
  const TentBins& bins_;
  const EvaluationOptions& options_;
};

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
Evaluation evaluate_family(const DesignShape& design, const Shape& shape, const Reflectance& reflectance,
                           const DesignRays& rays, const TentBins& bins, const EvaluationOptions& options) {
  const std::uint64_t per_task = options.rays / kBlockRays / kDesignTasks;
  const BlockTracer<Shape> tracer(shape, design.aperture(), reflectance, bins, options);
  const std::size_t groups = jacobian_groups(options.rays);
  std::vector<std::vector<double>> jacobians(options.derivatives ? groups : 0);
  std::vector<TaskSums> sums(kDesignTasks);
  parallel_blocks(options.derivatives ? groups : kDesignTasks, 1, [&](std::size_t group, std::size_t) {
    const std::size_t each = options.derivatives ? kDesignTasks / groups : 1;
    double* jacobian = nullptr;
    if (options.derivatives) {
      jacobians[group].assign(bins.size() * shape.coefficients().size(), 0.0);
      jacobian = jacobians[group].data();
    }
    for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
      sums[r].flux.assign(bins.size(), 0.0);
      for (std::uint64_t b = 0; b < per_task; ++b) {
        tracer.trace(rays.block(b * kDesignTasks + r), sums[r], jacobian);
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
