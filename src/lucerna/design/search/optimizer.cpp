// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/optimizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/peers.h"
#include "lucerna/design/initial/initial_guesses.h"
#include "lucerna/design/search/profile_search.h"

namespace lucerna {

namespace {

const std::array<Optimizer, 6>& known() {
  static const std::array<Optimizer, 6> kKnown{{{"auto", true, std::nullopt},
                                                {"least-squares", false, std::nullopt},
                                                {"tree", true, GlobalMethod::tree},
                                                {"annealing", true, GlobalMethod::annealing},
                                                {"cma-es", true, GlobalMethod::cma_es},
                                                {"direct", true, GlobalMethod::direct}}};
  return kKnown;
}

/// Rays of an evaluation of a search: noise far below what distinguishes basins.
constexpr std::uint64_t kSearchRays = std::uint64_t{1} << 15;
/// Half width of the box, over the mirror's radius.
constexpr double kReach = 0.06;
/// Error of a start (with what light it loses) from which profiles are not searched.
constexpr double kGoodGuess = 0.05;
/// Profiles that are compared at the screening stage before the best of them goes on.
constexpr std::size_t kProfilesCompared = 3;

struct Stopped {};

/// The costs of a batch, each computed by one process alone.
template <class Cost>
std::vector<double> costs_of(const FitProblem& problem, const std::vector<Eigen::VectorXd>& points,
                             const Cost& cost) {
  Peers* const peers = problem.rays->peers();
  StateKey key;
  for (const Eigen::VectorXd& point : points) key.add(point.sum());
  const UnsharedRays unshared(*problem.rays);
  const std::vector<std::string> dealt = dealt_items(peers, points.size(), key.value(), [&](std::size_t i) {
    std::string bytes;
    append_double(bytes, cost(points[i]));
    return bytes;
  });
  std::vector<double> costs;
  for (std::string_view bytes : dealt) costs.push_back(take_double(bytes));
  return costs;
}

/// Puts what a search among profiles finds before the other starts. False if `watch` ended it.
bool add_profiles(FitProblem& problem, const DesignShape& shape, std::uint64_t rays,
                  std::vector<double>& costs, const SearchWatch& watch, Progress& progress) {
  FitRecord record;
  record.stage = -1;
  bool whole = true;
  const auto on_progress = [&](const ProfileProgress& now) {
    progress.update("search", static_cast<std::uint64_t>(now.evaluations), kProfileEvaluations);
    const auto paid = static_cast<std::size_t>(now.evaluations);
    const bool fresh = paid > costs.size();
    costs.resize(std::max(paid, costs.size()), now.cost);
    record.error = std::sqrt(now.cost);
    record.rays = now.rays;
    record.total_rays = now.total_rays;
    record.evaluations = now.evaluations;
    ++record.step;
    return !fresh || watch(record, now.best);
  };
  std::vector<InitialGuess> found = profile_search(problem, shape, rays, on_progress, whole);
  problem.search_rays = record.total_rays;
  // The point source's solutions stay in reserve, should the search be misled.
  constexpr std::size_t kMax = 8;
  if (found.size() > kMax) found.erase(found.begin() + kMax, found.end());
  problem.compared = kProfilesCompared;
  found.insert(found.end(), problem.guesses.begin(), problem.guesses.end());
  std::stable_sort(found.begin(), found.end(),
                   [](const InitialGuess& a, const InitialGuess& b) { return a.cost < b.cost; });
  problem.guesses = std::move(found);
  return whole;
}

}  // namespace

std::string optimizer_names() {
  std::string names;
  for (const Optimizer& o : known()) names += (names.empty() ? "" : ", ") + o.name;
  return names;
}

Optimizer optimizer(std::string_view name) {
  for (const Optimizer& o : known()) {
    if (o.name == name) return o;
  }
  throw InputError(fmt::format("optimizer: found '{}', expected one of {}", name, optimizer_names()));
}

SearchSpace search_space(const DesignShape& about, const ContinuationSchedule& schedule) {
  // Enough knots for a shape, few enough for methods that learn from costs alone.
  const int max = about.is_revolution() ? 8 : 3;
  const int nx = std::min(max, schedule.last().intervals_x), ny = std::min(max, schedule.last().intervals_y);
  const DesignShape shape = about.refined(nx, about.is_revolution() ? about.intervals_y() : ny);
  const double half = kReach * shape.radius_mm();
  return {shape, {shape.parameters(), Eigen::VectorXd::Constant(shape.parameters().size(), half)}};
}

int search_evaluations(std::size_t parameters) { return 60 * static_cast<int>(parameters); }

bool prepare_guesses(FitProblem& problem, const DesignShape& shape, const ContinuationSchedule& schedule,
                     const Optimizer& optimizer, std::vector<double>& costs, const SearchWatch& watch,
                     Progress& progress) {
  problem.guesses.clear();
  if (!optimizer.zero_etendue) return true;
  problem.guesses = initial_guesses(problem, shape, progress);
  if (!optimizer.global) {
    // A start as good as this is in its basin already.
    return !can_search_profiles(problem, shape) || problem.guesses[0].cost < kGoodGuess * kGoodGuess ||
           add_profiles(problem, shape, schedule.last().rays, costs, watch, progress);
  }

  const SearchSpace space = search_space(problem.guesses[0].shape, schedule);
  const std::uint64_t rays = std::min(kSearchRays, schedule.last().rays);
  problem.rays->grow(rays, progress);
  const TentBins bins = rebinned(problem.bins, 1.0, problem.bins.count() / 3);
  const Eigen::VectorXd target = problem.target(bins);
  const SearchOptions options{problem.seed, search_evaluations(space.shape.parameter_count())};
  std::size_t asked = 0;
  FitRecord record;
  record.error = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best = space.shape.parameters();
  const BatchCost batch = [&](const std::vector<Eigen::VectorXd>& points) {
    const std::size_t n = points.size();
    std::vector<double> now(n);
    const bool fresh = asked + n > costs.size();
    if (!fresh) {
      std::copy_n(costs.begin() + static_cast<std::ptrdiff_t>(asked), n, now.begin());
    } else {
      now = costs_of(problem, points, [&](const Eigen::VectorXd& point) {
        const double cost = fit_cost(problem, space.shape.with(point), bins, target, rays);
        return std::isfinite(cost) ? cost : 1e30;
      });
      costs.resize(asked);  // a batch is paid for as a whole
      costs.insert(costs.end(), now.begin(), now.end());
    }
    asked += n;
    for (std::size_t i = 0; i < n; ++i) {
      if (!(std::sqrt(now[i]) < record.error)) continue;
      record.error = std::sqrt(now[i]);
      best = points[i];
    }
    record.rays = rays;
    record.evaluations = static_cast<int>(asked);
    record.total_rays = asked * rays;
    record.stage = -1;  // before the fit's first
    ++record.step;
    progress.update("search", asked, static_cast<std::uint64_t>(options.max_evaluations));
    if (fresh && !watch(record, space.shape.with(best))) throw Stopped();
    return now;
  };
  bool whole = true;
  try {
    global_search(*optimizer.global, space.box, options, batch);
  } catch (const Stopped&) {
    whole = false;
  }
  problem.search_rays = record.total_rays;
  const DesignShape found = space.shape.with(best);
  problem.guesses.insert(problem.guesses.begin(),
                         {found, InitialKnots::own_knots, record.error * record.error});
  return whole;
}

}  // namespace lucerna
