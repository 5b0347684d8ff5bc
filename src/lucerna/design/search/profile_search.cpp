// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/profile_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/core/parallel/peers.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/initial/initial_guesses.h"
#include "lucerna/design/initial/zone_table.h"
#include "lucerna/design/shape/perturbed.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kTableRays = std::uint64_t{1} << 22;
constexpr std::size_t kMaxParameters = 40;
/// Heights that the table knows, and sizes of random shapes, of hops, and of what counts as another shape,
/// over the mirror's radius.
constexpr double kHalfHeight = 0.08;
constexpr std::array<double, 3> kPerturbations{0.01, 0.02, 0.04};
constexpr std::array<double, 2> kHops{0.004, 0.01};
constexpr double kApart = 0.003;
constexpr int kFirstPerParameter = 300, kMaxFirst = 3000, kFirstSteps = 12, kSecondPerParameter = 30,
              kSecondSteps = 60;
constexpr int kHopsPerRound = 3, kHoppers = 48, kHoppersPerParameter = 5, kHopsEach = 8, kHopSteps = 30,
              kRetained = 96;
/// How many shapes a round traces, and with how many rays: the fewer are left the better they are known.
struct Round {
  int shapes;
  std::uint64_t rays;
};
constexpr std::array<Round, 2> kSearchRounds{{{8, 1 << 20}, {3, 1 << 22}}};
static_assert([] {
  int all = 0;
  for (const Round& r : kSearchRounds) all += r.shapes;
  return all;
}() == kProfileEvaluations);
/// Shapes that are traced between two looks at the clock.
constexpr std::size_t kBatch = 4;
/// Beyond so far (over the radius) what a trace showed beside the table counts by half.
constexpr double kTrust = 0.02;
/// Longest change of a height in one step, over the radius.
constexpr double kLongestMove = 0.05;

struct Candidate {
  DesignShape shape;
  double cost = 0.0;
};

bool cheaper(const Candidate& a, const Candidate& b) { return a.cost < b.cost; }

/// A shape that was traced, and what the table lacks there: light, and its derivatives.
struct Traced {
  Candidate candidate;
  Eigen::VectorXd beside_table;
  BinJacobian slope_beside_table;
  int round = 0;
};

class Search {
 public:
  Search(const FitProblem& problem, const DesignShape& shape, std::uint64_t rays)
      : problem_(problem),
        shape_(shape),
        rays_(rays),
        radius_mm_(shape.aperture().outer_radius_mm()),
        target_(problem.target(problem.bins)),
        table_(shape, problem.reflectance, *problem.rays, std::min(rays, kTableRays), problem.bins,
               kHalfHeight * radius_mm_, direct_light()) {}

  std::vector<Candidate> first() {
    const DesignShape few = shape_.refined(std::max(2, shape_.intervals_x() / 2), shape_.intervals_y());
    std::vector<Candidate> all;
    const int parameters =
        std::min(static_cast<int>(shape_.parameter_count()), kMaxFirst / kFirstPerParameter);
    for (int i = 0; i < kFirstPerParameter * parameters; ++i) {
      const double size = kPerturbations[static_cast<std::size_t>(i) % kPerturbations.size()];
      // Every other shape is smooth: many knots by chance alone are only waves.
      const DesignShape other = perturb(i % 2 == 0 ? shape_ : few, size);
      all.push_back({other.refined(shape_.intervals_x(), shape_.intervals_y())});
    }
    all.push_back({shape_});
    descend(all, kFirstSteps);
    std::stable_sort(all.begin(), all.end(), cheaper);
    all.resize(static_cast<std::size_t>(kSecondPerParameter * parameters), all.front());
    descend(all, kSecondSteps);
    return distinct(std::move(all));
  }

  std::vector<Candidate> hop(std::vector<Candidate> from) {
    const auto hoppers = std::min<std::size_t>(kHoppers, kHoppersPerParameter * shape_.parameter_count());
    for (int hop = 0; hop < kHopsPerRound; ++hop) {
      if (from.size() > hoppers) from.resize(hoppers, from.front());
      const std::size_t n = from.size();
      for (std::size_t i = 0; i < n; ++i) {
        for (int k = 0; k < kHopsEach; ++k) {
          from.push_back({perturb(from[i].shape, kHops[static_cast<std::size_t>(k) % kHops.size()])});
        }
      }
      descend(from, kHopSteps);
      from = distinct(std::move(from));
    }
    return from;
  }

  /// Traces some candidates, from `first` on. Returns their number.
  std::size_t trace(const std::vector<Candidate>& candidates, int round, std::size_t first) {
    const auto& [shapes, rays] = kSearchRounds[static_cast<std::size_t>(round)];
    const std::size_t last = std::min({candidates.size(), static_cast<std::size_t>(shapes), first + kBatch});
    const std::size_t n = last - first;
    EvaluationOptions options;
    options.rays = std::min(rays_, rays);
    options.direct_light = problem_.direct_light;
    problem_.rays->grow(options.rays);
    std::vector<Traced> now;
    for (std::size_t i = 0; i < n; ++i) now.push_back({candidates[first + i], {}, {}, round});
    for_each_shared(problem_.rays->peers(), n, [&](std::size_t i) {
      Candidate& c = now[i].candidate;
      const Evaluation e = evaluate(c.shape, problem_.reflectance, *problem_.rays, problem_.bins, options);
      const Evaluation table = table_.evaluate(c.shape);
      const double cost = fit_cost(problem_, c.shape, e, problem_.bins, target_);
      c.cost = std::isfinite(cost) ? cost : 1e30;
      now[i].beside_table = e.flux - table.flux;
      now[i].slope_beside_table = e.jacobian - table.jacobian;
    });
    evaluations_ += static_cast<int>(n);
    total_rays_ += n * options.rays;
    traced_.insert(traced_.end(), now.begin(), now.end());
    std::stable_sort(traced_.begin(), traced_.end(), [](const Traced& a, const Traced& b) {
      return a.round != b.round ? a.round > b.round : cheaper(a.candidate, b.candidate);
    });
    return n;
  }
  /// The last round first, each by cost.
  const std::vector<Traced>& traced() const { return traced_; }
  ProfileProgress progress(std::uint64_t rays) const {
    return {traced_.front().candidate.shape, traced_.front().candidate.cost, evaluations_, rays, total_rays_};
  }

 private:
  /// Light that passes the mirror: the same for all shapes, but for the little that the rim moves.
  Eigen::VectorXd direct_light() const {
    const auto bins = static_cast<Eigen::Index>(problem_.bins.size());
    if (!problem_.direct_light) return Eigen::VectorXd::Zero(bins);
    EvaluationOptions options;
    options.rays = std::min(rays_, kTableRays);
    options.derivatives = false;
    const Evaluation all = evaluate(shape_, problem_.reflectance, *problem_.rays, problem_.bins, options);
    options.direct_light = false;
    return all.flux - evaluate(shape_, problem_.reflectance, *problem_.rays, problem_.bins, options).flux;
  }

  DesignShape perturb(const DesignShape& shape, double size) {
    return perturbed(shape, size * radius_mm_,
                     Rng(problem_.seed, (std::uint64_t{1} << 32) + perturbations_++));
  }

  /// The nearest shape that was traced.
  const Traced* nearest(const DesignShape& shape) const {
    const Traced* found = nullptr;
    double min = 0.0;
    for (const Traced& t : traced_) {
      const double d = (t.candidate.shape.parameters() - shape.parameters()).squaredNorm();
      if (found != nullptr && d >= min) continue;
      min = d;
      found = &t;
    }
    return found;
  }

  NormalEquations equations(const DesignShape& shape, const Traced* known) const {
    Evaluation e = table_.evaluate(shape);
    if (known != nullptr) {
      const Eigen::VectorXd away = shape.parameters() - known->candidate.shape.parameters();
      const double far = away.cwiseAbs().maxCoeff() / (kTrust * radius_mm_);
      const double trust = 1.0 / (1.0 + far * far);
      e.flux += known->beside_table + trust * (known->slope_beside_table * away);
      e.jacobian += trust * known->slope_beside_table;
    }
    NormalEquations out = normal_equations(e, target_, problem_.bins, problem_.mode);
    if (problem_.flux_weight > 0.0) {
      add_missing_light(e, problem_.flux_weight, problem_.flux_reference, out);
    }
    return out;
  }

  /// Levenberg-Marquardt on the table.
  void descend(Candidate& c, int max_steps) const {
    const Traced* known = nearest(c.shape);
    NormalEquations now = equations(c.shape, known);
    double lambda = 1e-2;
    int slow = 0;
    for (int step = 0; step < max_steps && slow < 3 && lambda < 1e4; ++step) {
      Eigen::VectorXd move = damped_step(now, lambda);
      while (!(move.cwiseAbs().maxCoeff() <= kLongestMove * radius_mm_) && lambda < kMaxLambda) {
        lambda *= 4.0;
        move = damped_step(now, lambda);
      }
      if (!move.allFinite()) break;
      const DesignShape trial = c.shape.with(c.shape.parameters() + move);
      NormalEquations next = equations(trial, known);
      if (!(next.cost < now.cost)) {
        lambda *= 5.0;
        continue;
      }
      lambda = next_lambda(lambda, now, move, next.cost);
      slow = next.cost > 0.96 * now.cost ? slow + 1 : 0;
      c.shape = trial;
      now = std::move(next);
    }
    c.cost = now.cost;
  }
  void descend(std::vector<Candidate>& all, int max_steps) const {
    parallel_blocks(all.size(), 8, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) descend(all[i], max_steps);
    });
  }

  /// The cheapest that are no copies of cheaper ones.
  std::vector<Candidate> distinct(std::vector<Candidate> all) const {
    std::stable_sort(all.begin(), all.end(), cheaper);
    std::vector<Candidate> out;
    for (Candidate& c : all) {
      const bool other = std::all_of(out.begin(), out.end(), [&](const Candidate& o) {
        return (c.shape.parameters() - o.shape.parameters()).cwiseAbs().maxCoeff() > kApart * radius_mm_;
      });
      if (other) out.push_back(std::move(c));
      if (out.size() == kRetained) break;
    }
    return out;
  }

  const FitProblem& problem_;
  const DesignShape& shape_;
  std::uint64_t rays_;
  double radius_mm_;
  Eigen::VectorXd target_;
  ZoneTable table_;
  std::vector<Traced> traced_;
  std::uint64_t perturbations_ = 0;
  int evaluations_ = 0;
  std::uint64_t total_rays_ = 0;
};

}  // namespace

bool can_search_profiles(const FitProblem& problem, const DesignShape& shape) {
  return !problem.limits && problem.rays->shadows() == nullptr && shape.is_revolution() &&
         problem.bins.is_rings() && std::abs(problem.bins.axes().ez().z) > 0.999999 &&
         shape.parameter_count() <= kMaxParameters;
}

std::vector<InitialGuess> profile_search(const FitProblem& problem, const DesignShape& shape,
                                         std::uint64_t rays, const ProfileWatch& watch, bool& whole) {
  problem.rays->grow(std::min(rays, kTableRays));
  Search search(problem, shape, rays);
  std::vector<Candidate> candidates = search.first();
  whole = true;
  for (int round = 0; round < static_cast<int>(kSearchRounds.size()) && whole; ++round) {
    const auto r = static_cast<std::size_t>(round);
    candidates = search.hop(std::move(candidates));
    for (std::size_t at = 0; whole;) {
      const std::size_t n = search.trace(candidates, round, at);
      if (n == 0) break;
      at += n;
      whole = watch(search.progress(std::min(rays, kSearchRounds[r].rays)));
    }
  }
  std::vector<InitialGuess> guesses;
  for (const Traced& t : search.traced()) {
    guesses.push_back({t.candidate.shape, InitialKnots::end, t.candidate.cost});
  }
  return guesses;
}

}  // namespace lucerna
