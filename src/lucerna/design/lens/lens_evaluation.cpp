// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_evaluation.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/evaluation/evaluation_sums.h"
#include "lucerna/design/lens/lens_path.h"

namespace lucerna {

namespace {

/// Rays that touch the surface at less than this cosine tell nothing of its derivatives.
constexpr double kGrazing = 1e-3;

/// Sums of the rays of one task.
struct LensSums {
  std::vector<double> flux;
  /// Bins x numbers, row by row; null without derivatives.
  double* jacobian = nullptr;
  std::size_t numbers = 0;
  double weight = 0.0, through = 0.0, direct = 0.0, absorbed = 0.0, lost = 0.0;
};

/// What the ways with one and with two partial reflections count; 0: they are not followed.
struct GhostWeights {
  double once = 0.0, twice = 0.0;
};

/// Adds the light of rays of one lens to sums.
class LensCounter {
 public:
  LensCounter(const LensCurves& curves, const MediumView& medium, const TentBins& bins,
              const LensEvaluationOptions& options)
      : curves_(curves), medium_(medium), bins_(bins), options_(options), tracer_(curves, medium) {}

  /// `ghosts`: over the weight.
  void add(const Vec3& origin, const Vec3& direction, double weight, const GhostWeights& ghosts,
           LensSums& sums) {
    sums.weight += weight;
    tracer_.follow(origin, direction, kNoGhost, path_);
    count(weight, weight * (1.0 - path_.clear), options_.edge_mm, sums);
    if (ghosts.once == 0.0 || path_.end == LensEnd::direct) return;
    const int partial = path_.partial;
    for (int k = 0; k < partial; ++k) {
      add_ghost(origin, direction, {k}, ghosts.once * weight, sums);
      if (ghosts.twice == 0.0) continue;
      const int partial_again = path_.partial;
      for (int m = k + 1; m < partial_again; ++m)
        add_ghost(origin, direction, {k, m}, ghosts.twice * weight, sums);
    }
  }

 private:
  void add_ghost(const Vec3& origin, const Vec3& direction, const Ghost& ghost, double weight,
                 LensSums& sums) {
    tracer_.follow(origin, direction, ghost, path_);
    count(weight, weight * (1.0 - path_.clear), 0.0, sums);
  }

  void count(double weight, double absorbed, double edge_mm, LensSums& sums) {
    const double share = path_.share();
    sums.absorbed += 0.5 * (path_.s + path_.p) * absorbed;
    if (path_.end == LensEnd::lost) {
      sums.lost += weight * share;
      return;
    }
    (path_.end == LensEnd::direct ? sums.direct : sums.through) += weight * share;
    TentDeposit d;
    bins_.deposit(path_.origin, path_.direction, d);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k)
      sums.flux[static_cast<std::size_t>(d.bin[k])] += weight * share * d.weight[k];
    if (sums.jacobian == nullptr || d.n == 0 || path_.hits == 0 || path_.hits > options_.smooth_hits ||
        grazes())
      return;
    differentiate(weight, d, sums);
    if (edge_mm > 0.0) {
      for (int i = 0; i < path_.hits; ++i) add_edges(i, edge_mm, weight * share, d, sums);
    }
  }

  bool grazes() const {
    const auto* const end = path_.hit.data() + path_.hits;
    return std::any_of(path_.hit.data(), end, [](const LensHit& h) { return h.c < kGrazing; });
  }

  void differentiate(double weight, const TentDeposit& d, LensSums& sums) const {
    std::array<LensAdjoint, kMaxLensHits> by_u, by_v{}, by_share;
    const TentGradient in_u = bins_.gradient_u(path_.origin, path_.direction);
    const int last = path_.hits - 1;
    lens_adjoint(path_, medium_, last, in_u.direction, in_u.origin, false, by_u.data());
    if (!bins_.is_rings()) {
      const TentGradient in_v = bins_.gradient_v(path_.origin, path_.direction);
      lens_adjoint(path_, medium_, last, in_v.direction, in_v.origin, false, by_v.data());
    }
    lens_adjoint(path_, medium_, last, {}, {}, true, by_share.data());
    const double share = path_.share();
    for (std::size_t i = 0; i <= static_cast<std::size_t>(last); ++i) {
      const LensHit& hit = path_.hit[i];
      const int first = curves_.pieces()[static_cast<std::size_t>(hit.piece)].first_number;
      if (first < 0) continue;
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        const double u = share * d.du[k], v = share * d.dv[k], w = d.weight[k];
        const LensAdjoint by{u * by_u[i].rise + v * by_v[i].rise + w * by_share[i].rise,
                             u * by_u[i].turn + v * by_v[i].turn + w * by_share[i].turn};
        add_row(piece_derivatives(hit, by), weight, first, d.bin[k], sums);
      }
    }
  }

  static void add_row(const std::array<double, kPieceNumbers>& numbers, double weight, int first, int bin,
                      LensSums& sums) {
    double* const row = sums.jacobian + static_cast<std::size_t>(bin) * sums.numbers + first;
    for (std::size_t j = 0; j < numbers.size(); ++j) row[j] += weight * numbers[j];
  }

  /// Light that a face gains or loses at its edges: a strip along them represents it.
  void add_edges(int last, double edge_mm, double flux, const TentDeposit& d, LensSums& sums) const {
    const LensHit& hit = path_.hit[static_cast<std::size_t>(last)];
    const LensPiece& piece = curves_.pieces()[static_cast<std::size_t>(hit.piece)];
    const double r = std::hypot(hit.point.x, hit.point.y);
    for (const bool at_end : {false, true}) {
      if (!(at_end ? piece.edge_at_to : piece.edge_at_from)) continue;
      const OutlinePoint& edge = at_end ? piece.curve.to : piece.curve.from;
      if (!(std::hypot(r - edge[0], hit.point.z - edge[1]) < edge_mm)) continue;
      const double inward = at_end ? -1.0 : 1.0;
      std::array<LensAdjoint, kMaxLensHits> by;
      lens_adjoint(path_, medium_, last, {}, inward * hit.along, false, by.data());
      const int number = at_end ? piece.to_edge_number : piece.from_edge_number;
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        const double density = flux * d.weight[k] / edge_mm;
        for (std::size_t i = 0; i <= static_cast<std::size_t>(last); ++i) {
          const LensHit& before = path_.hit[i];
          const int first = curves_.pieces()[static_cast<std::size_t>(before.piece)].first_number;
          if (first >= 0) add_row(piece_derivatives(before, by[i]), density, first, d.bin[k], sums);
        }
        if (number < 0) continue;
        double* const row = sums.jacobian + static_cast<std::size_t>(d.bin[k]) * sums.numbers + number;
        row[0] += density * inward * hit.nz;  // less the edge's own way along the tangent
        row[1] -= density * inward * hit.nr;
      }
    }
  }

  const LensCurves& curves_;
  MediumView medium_;
  const TentBins& bins_;
  LensEvaluationOptions options_;
  LensTracer tracer_;
  LensPath path_;
};

/// Jacobians that are summed apart: by the number of rays alone, so that the sums never depend on threads.
std::size_t groups_of(std::uint64_t rays) {
  std::size_t groups = 4;
  while (groups < kDesignTasks && rays / groups > (1u << 16)) groups *= 2;
  return groups;
}

/// Which blocks of rays are followed through partial reflections, and what they count: whole ones, for
/// neighbours in a Sobol sequence are spread evenly, of all streams and tasks alike.
class GhostBlocks {
 public:
  GhostBlocks(int every, std::uint64_t blocks_per_task)
      : once_(static_cast<std::uint64_t>(every)), twice_(once_ * once_) {
    if (every == 0) return;
    for (std::uint64_t b = 0; b < blocks_per_task; ++b) {
      for (std::uint64_t task = 0; task < kDesignTasks; ++task) {
        if (is_one_in(once_, b, task)) weights_.once += 1.0;
        if (is_one_in(twice_, b, task)) weights_.twice += 1.0;
      }
    }
    const auto all = static_cast<double>(blocks_per_task * kDesignTasks);
    weights_ = {all / weights_.once, all / weights_.twice};
  }

  GhostWeights weights(std::uint64_t block, std::uint64_t task) const {
    if (once_ == 0 || !is_one_in(once_, block, task)) return {};
    return {weights_.once, is_one_in(twice_, block, task) ? weights_.twice : 0.0};
  }

 private:
  static bool is_one_in(std::uint64_t every, std::uint64_t block, std::uint64_t task) {
    return (block + task / kDesignStreams) % every == 0;
  }

  std::uint64_t once_, twice_;
  GhostWeights weights_;
};

EvaluationSums lens_total(const std::vector<LensSums>& tasks, std::size_t bins) {
  EvaluationSums sums;
  for (std::vector<double>& flux : sums.flux) flux.assign(bins, 0.0);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    std::vector<double>& stream = sums.flux[t % kDesignStreams];
    for (std::size_t b = 0; b < bins; ++b) stream[b] += tasks[t].flux[b];
    sums.weight += tasks[t].weight;
    sums.reflected += tasks[t].through;
    sums.direct += tasks[t].direct;
    sums.absorbed += tasks[t].absorbed;
    sums.lost += tasks[t].lost;
  }
  return sums;
}

}  // namespace

Evaluation evaluate_lens(const LensShape& shape, const MediumView& medium, const DesignRays& rays,
                         const TentBins& bins, const LensEvaluationOptions& options) {
  const std::uint64_t per_task = options.rays / kBlockRays / kDesignTasks;
  LUCERNA_CHECK(per_task > 0 && options.rays <= rays.size(), "{} rays of {}", options.rays, rays.size());
  const LensCurves curves(shape);
  const std::size_t groups = groups_of(options.rays), each = kDesignTasks / groups;
  const GhostBlocks ghosts(options.ghost_every, per_task);
  std::vector<std::vector<double>> jacobians(options.derivatives ? groups : 0);
  std::vector<LensSums> sums(kDesignTasks);
  parallel_blocks(groups, 1, [&](std::size_t group, std::size_t) {
    if (options.derivatives) jacobians[group].assign(bins.size() * curves.number_count(), 0.0);
    const auto counter = std::make_unique<LensCounter>(curves, medium, bins, options);
    for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
      sums[r].flux.assign(bins.size(), 0.0);
      sums[r].numbers = curves.number_count();
      if (options.derivatives) sums[r].jacobian = jacobians[group].data();
      for (std::uint64_t b = 0; b < per_task; ++b) {
        const DesignRays::Block& block = rays.block(b * kDesignTasks + r);
        const GhostWeights of_block = ghosts.weights(b, r);
        for (std::size_t i = 0; i < kBlockRays; ++i) {
          const double weight = block.weight[i];
          const Vec3 along = Direction::from({block.kx[i], block.ky[i], block.kz[i]}).vec();
          counter->add({block.x_mm[i], block.y_mm[i], block.z_mm[i]}, along, weight, of_block, sums[r]);
        }
      }
    }
  });
  const EvaluationSums all = lens_total(sums, bins.size());
  Evaluation e = evaluation_of(all);
  e.rays = per_task * kDesignTasks * kBlockRays;
  if (!options.derivatives) return e;
  using Rows = Eigen::Map<const BinJacobian>;
  const auto rows = static_cast<Eigen::Index>(bins.size());
  BinJacobian by_numbers = BinJacobian::Zero(rows, static_cast<Eigen::Index>(curves.number_count()));
  for (const std::vector<double>& part : jacobians) by_numbers += Rows(part.data(), rows, by_numbers.cols());
  e.jacobian = (1.0 / all.weight) * (by_numbers * number_jacobian(shape));
  return e;
}

double share_within(const LensShape& shape, const DesignRays& rays, std::uint64_t count) {
  const LensCurves curves(shape);
  const LensTracer tracer(curves, {1.0, 0.0});
  double within = 0.0, all = 0.0;
  for (std::uint64_t b = 0; b < std::min(count, rays.size()) / kBlockRays; ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const double weight = block.weight[i];
      all += weight;
      if (tracer.begins_inside({block.x_mm[i], block.y_mm[i], block.z_mm[i]},
                               {block.kx[i], block.ky[i], block.kz[i]}))
        within += weight;
    }
  }
  return within / all;
}

}  // namespace lucerna
