// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/initial_guesses.h"

#include <algorithm>
#include <cmath>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/initial/zero_etendue.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kGuessRays = std::uint64_t{1} << 16;

EvaluationOptions plain_options(const FitProblem& problem, std::uint64_t rays) {
  EvaluationOptions options;
  options.rays = rays;
  options.derivatives = false;
  options.direct_light = problem.direct_light;
  return options;
}

/// Root mean square angle of the source about its middle, as the vertex sees it.
double blur_rad(const DesignRays& rays, const PointSource& source, const DesignShape& shape) {
  double square = 0.0, weight = 0.0;
  for (std::uint64_t b = 0; b < std::min<std::uint64_t>(16, rays.size() / kBlockRays); ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t k = 0; k < kBlockRays; ++k) {
      // How far the ray passes by the middle.
      const Vec3 o = Vec3{block.x_mm[k], block.y_mm[k], block.z_mm[k]} - source.at_mm;
      const Vec3 d{block.kx[k], block.ky[k], block.kz[k]};
      const Vec3 across = o - dot(o, d) * d;
      const double w = block.weight[k];
      square += w * dot(across, across);
      weight += w;
    }
  }
  const double distance = std::max(1e-6, std::abs(source.at_mm.z - shape.at(0, 0).z_mm));
  return std::sqrt(square / weight) / distance;
}

/// A mirror of revolution or a trough, moved along its axis.
DesignShape with_vertex(const DesignShape& shape, double vertex_mm) {
  return shape.with((shape.parameters().array() + (vertex_mm - shape.at(0.0, 0.0).z_mm)).matrix());
}

/// The shape as given, and of revolution moved so that its vertex is so far from the source, over the
/// mirror's radius. Which distance suits a target cannot be told before: near mirrors catch more, far ones
/// blur less.
std::vector<DesignShape> at_vertex_distances(const DesignShape& shape, const Vec3& source_mm) {
  constexpr double kOverRadius[] = {0.3, 0.45, 0.7, 1.0};
  std::vector<DesignShape> out{shape};
  if (!shape.is_revolution()) return out;
  for (const double distance : kOverRadius)
    out.push_back(with_vertex(shape, source_mm.z - distance * shape.radius_mm()));
  return out;
}

}  // namespace

std::vector<DirectedFlux> target_light(const FitProblem& problem, const DesignShape& shape) {
  problem.rays->grow(kGuessRays);
  // Of a trough's light only the angle across counts.
  const int count = problem.bins.is_rings() ? 240 : shape.is_trough() ? 64 : 16;
  const TentBins bins = rebinned(problem.bins, 1.0, count);
  Eigen::VectorXd flux = problem.target(bins);
  if (problem.direct_light) {
    EvaluationOptions options = plain_options(problem, kGuessRays);
    const Evaluation all = evaluate(shape, problem.reflectance, *problem.rays, bins, options);
    options.direct_light = false;
    const Evaluation mirror = evaluate(shape, problem.reflectance, *problem.rays, bins, options);
    // By shape, the target is as bright as all that lands in the window.
    const double scale = problem.mode == TargetMode::shape ? all.flux.sum() / flux.sum() : 1.0;
    flux = (scale * flux - (all.flux - mirror.flux)).cwiseMax(0.0);
  }
  std::vector<DirectedFlux> light;
  const Vec3 vertex{0.0, 0.0, shape.at(0.0, 0.0).z_mm};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double f = flux[static_cast<Eigen::Index>(i)];
    if (f > 0.0) light.push_back({bin_direction(bins, i, vertex), f});
  }
  return light;
}

Evaluation evaluate_start(const FitProblem& problem, const DesignShape& shape, const TentBins& bins,
                          std::uint64_t rays) {
  return evaluate(shape, problem.reflectance, *problem.rays, bins, plain_options(problem, rays));
}

double fit_cost(const FitProblem& problem, const DesignShape& shape, const TentBins& bins,
                const Eigen::VectorXd& target, std::uint64_t rays) {
  return fit_cost(problem, shape, evaluate_start(problem, shape, bins, rays), bins, target);
}

double fit_cost(const FitProblem& problem, const DesignShape& shape, const Evaluation& e,
                const TentBins& bins, const Eigen::VectorXd& target) {
  const double error = bin_error(e, target, bins, problem.mode).relative_rms;
  double cost = error * error;
  cost += problem.limits_cost(shape, e.rays, nullptr);
  const double missing = 1.0 - e.flux.sum() / problem.flux_reference;
  return cost + problem.flux_weight * missing * missing;
}

std::optional<DesignShape> trough_guess(const FitProblem& problem, const DesignShape& family,
                                        const TransportChoice& choice) {
  problem.rays->grow(kGuessRays);
  const PointSource source = point_source(*problem.rays, kGuessRays);
  const DesignShape at = with_vertex(family, source.at_mm.z - choice.vertex_distance_mm);
  return trough_balance(family, source, target_light(problem, at), choice.vertex_distance_mm,
                        choice.sign < 0.0);
}

std::vector<InitialGuess> initial_guesses(const FitProblem& problem, const DesignShape& shape,
                                          Progress& progress) {
  problem.rays->grow(kGuessRays, progress);
  progress.update("starts", 0, 0);
  const PointSource source = point_source(*problem.rays, kGuessRays);
  const double blur = blur_rad(*problem.rays, source, shape);
  std::vector<InitialGuess> guesses{{shape}};
  const std::vector<DirectedFlux> target_flux = target_light(problem, shape);
  for (const DesignShape& family : at_vertex_distances(shape, source.at_mm)) {
    for (const DesignShape& s : zero_etendue_shapes(family, source, target_flux, blur)) {
      guesses.push_back({s, InitialKnots::own_knots});
    }
  }
  const TentBins bins = rebinned(problem.bins, 1.0, problem.bins.count() / 3);
  const Eigen::VectorXd target = problem.target(bins);
  for (InitialGuess& s : guesses) s.cost = fit_cost(problem, s.shape, bins, target, kGuessRays);
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const InitialGuess& a, const InitialGuess& b) { return a.cost < b.cost; });
  return guesses;
}

}  // namespace lucerna
