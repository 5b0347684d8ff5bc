// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

namespace lucerna {

/// Ways to look for a basin without derivatives, over a box of parameters.
enum class GlobalMethod {
  tree,       ///< a search tree whose ranges narrow at every level, Hooke-Jeeves at its leaves (Mas 2010)
  annealing,  ///< simulated annealing, several chains (Kirkpatrick et al. 1983)
  cma_es,     ///< covariance matrix adaptation, restarts with doubled populations (Auger and Hansen 2005)
  direct,     ///< dividing rectangles, locally biased (Jones et al. 1993; Gablonsky and Kelley 2001)
};

std::string_view to_string(GlobalMethod method);

/// Costs of some points, in their order. Points of one batch do not depend on each other, so they may be
/// evaluated in parallel. May throw to end a search.
using BatchCost = std::function<std::vector<double>(const std::vector<Eigen::VectorXd>&)>;

/// Parameters within centre +- half (half > 0).
struct SearchBox {
  Eigen::VectorXd centre, half;
};

struct SearchOptions {
  std::uint64_t seed = 1;
  /// Evaluations after which the search ends; it evaluates exactly so many, unless it divides no further.
  int max_evaluations = 1000;
};

struct GlobalSearchResult {
  Eigen::VectorXd best;
  double cost = 0.0;
  int evaluations = 0;
};

/// Looks for the least cost in the box; the centre is always among what is tried. What is asked next depends
/// on the seed and the costs alone: a search that is given the same costs again asks the same points (how a
/// checkpoint of costs resumes it). Costs that are not finite count as worse than any.
GlobalSearchResult global_search(GlobalMethod method, const SearchBox& box, const SearchOptions& options,
                                 const BatchCost& cost);

namespace detail {

/// What all methods share: the box as [-1, 1]^n, the budget and the best so far.
class GlobalSearchRun {
 public:
  GlobalSearchRun(const SearchBox& box, const SearchOptions& options, const BatchCost& cost);

  Eigen::Index size() const { return box_.centre.size(); }
  std::uint64_t seed() const { return options_.seed; }
  bool spent() const { return best_.evaluations >= options_.max_evaluations; }
  /// Share of the budget that is used.
  double used() const { return static_cast<double>(best_.evaluations) / options_.max_evaluations; }
  /// Costs of points in [-1, 1]^n (clipped to it); what the budget does not reach costs infinity.
  std::vector<double> costs(const std::vector<Eigen::VectorXd>& points);
  const GlobalSearchResult& best() const { return best_; }
  /// The best so far in [-1, 1]^n.
  const Eigen::VectorXd& best_point() const { return best_point_; }

 private:
  SearchBox box_;
  SearchOptions options_;
  const BatchCost& cost_;
  GlobalSearchResult best_;
  Eigen::VectorXd best_point_;
};

void search_tree(GlobalSearchRun& run);
void anneal(GlobalSearchRun& run);
void cma_es(GlobalSearchRun& run);
void direct(GlobalSearchRun& run);

}  // namespace detail

}  // namespace lucerna
