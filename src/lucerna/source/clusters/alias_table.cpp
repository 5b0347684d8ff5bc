// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/alias_table.h"

#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

void build_alias(std::span<const double> weights, std::span<float> probability,
                 std::span<std::uint32_t> alias) {
  const std::size_t n = weights.size();
  LUCERNA_CHECK(n > 0 && probability.size() == n && alias.size() == n, "{} weights, {} and {}", n,
                probability.size(), alias.size());
  double sum = 0.0;
  for (const double w : weights) {
    LUCERNA_CHECK(std::isfinite(w) && w >= 0.0, "weight {}", w);
    sum += w;
  }
  LUCERNA_CHECK(sum > 0.0 && std::isfinite(sum), "weights sum to {}", sum);

  std::vector<double> scaled(n);
  std::vector<std::uint32_t> small, large;
  std::uint32_t heaviest = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    scaled[i] = weights[i] / sum * static_cast<double>(n);
    (scaled[i] < 1.0 ? small : large).push_back(i);
    if (weights[i] > weights[heaviest]) heaviest = i;
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    probability[s] = static_cast<float>(scaled[s]);
    alias[s] = l;
    scaled[l] -= 1.0 - scaled[s];
    if (scaled[l] < 1.0) {
      large.pop_back();
      small.push_back(l);
    }
  }
  // What is left is 1 but for rounding; an item of weight 0 must not gain by that.
  for (const auto* rest : {&small, &large}) {
    for (const std::uint32_t i : *rest) {
      probability[i] = weights[i] > 0.0 ? 1.0f : 0.0f;
      alias[i] = weights[i] > 0.0 ? i : heaviest;
    }
  }
}

AliasTable::AliasTable(std::span<const double> weights)
    : probability_(weights.size()), alias_(weights.size()) {
  build_alias(weights, probability_, alias_);
}

}  // namespace lucerna
