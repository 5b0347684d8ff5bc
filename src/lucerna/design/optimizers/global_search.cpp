// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/optimizers/global_search.h"

#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"

namespace lucerna {

std::string_view to_string(GlobalMethod method) {
  switch (method) {
    case GlobalMethod::tree:
      return "tree";
    case GlobalMethod::annealing:
      return "annealing";
    case GlobalMethod::cma_es:
      return "cma-es";
    case GlobalMethod::direct:
      return "direct";
  }
  return "";
}

namespace detail {

GlobalSearchRun::GlobalSearchRun(const SearchBox& box, const SearchOptions& options, const BatchCost& cost)
    : box_(box), options_(options), cost_(cost), best_point_(Eigen::VectorXd::Zero(box.centre.size())) {
  LUCERNA_CHECK(box.centre.size() > 0 && box.centre.size() == box.half.size() && box.half.minCoeff() > 0.0,
                "a search box of {} by {} numbers", box.centre.size(), box.half.size());
  LUCERNA_CHECK(options.max_evaluations > 0, "a search of {} evaluations", options.max_evaluations);
  best_.best = box.centre;
  best_.cost = std::numeric_limits<double>::infinity();
  costs({best_point_});
}

std::vector<double> GlobalSearchRun::costs(const std::vector<Eigen::VectorXd>& points) {
  constexpr double kWorst = std::numeric_limits<double>::infinity();
  const auto left = static_cast<std::size_t>(options_.max_evaluations - best_.evaluations);
  const std::size_t n = std::min(points.size(), left);
  std::vector<Eigen::VectorXd> in_box;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::VectorXd y = points[i].cwiseMax(-1.0).cwiseMin(1.0);
    in_box.emplace_back(box_.centre + box_.half.cwiseProduct(y));
  }
  std::vector<double> result = n > 0 ? cost_(in_box) : std::vector<double>();
  LUCERNA_CHECK(result.size() == n, "{} costs of {} points", result.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(result[i])) result[i] = kWorst;
    if (result[i] >= best_.cost) continue;
    best_.cost = result[i];
    best_.best = in_box[i];
    best_point_ = points[i].cwiseMax(-1.0).cwiseMin(1.0);
  }
  best_.evaluations += static_cast<int>(n);
  result.resize(points.size(), kWorst);
  return result;
}

}  // namespace detail

GlobalSearchResult global_search(GlobalMethod method, const SearchBox& box, const SearchOptions& options,
                                 const BatchCost& cost) {
  detail::GlobalSearchRun run(box, options, cost);
  switch (method) {
    case GlobalMethod::tree:
      detail::search_tree(run);
      break;
    case GlobalMethod::annealing:
      detail::anneal(run);
      break;
    case GlobalMethod::cma_es:
      detail::cma_es(run);
      break;
    case GlobalMethod::direct:
      detail::direct(run);
      break;
  }
  return run.best();
}

}  // namespace lucerna
