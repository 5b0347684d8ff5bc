// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/host_device.h"

namespace lucerna {

/// Fills `probability` and `alias` (as long as `weights`) so that `alias_pick` chooses item i with
/// probability weights[i] / sum: Vose's form of Walker's method (M. D. Vose, IEEE Trans. Software Eng. 17(9),
/// 1991). Weights are finite and >= 0 with a positive sum (checked). O(n).
void build_alias(std::span<const double> weights, std::span<float> probability,
                 std::span<std::uint32_t> alias);

/// Chooses one of `n` >= 1 items with one number u in [0, 1): one look-up. Thread safe. Items of weight 0 are
/// never chosen.
LUCERNA_HD inline std::uint32_t alias_pick(const float* probability, const std::uint32_t* alias,
                                           std::size_t n, double u) {
  const double place = u * static_cast<double>(n);
  const std::size_t cell = static_cast<std::size_t>(place);
  const std::size_t i = cell < n ? cell : n - 1;
  return place - static_cast<double>(i) < static_cast<double>(probability[i]) ? static_cast<std::uint32_t>(i)
                                                                              : alias[i];
}

/// An alias table that owns its arrays.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(std::span<const double> weights);

  std::size_t size() const { return probability_.size(); }
  std::uint32_t pick(double u) const { return alias_pick(probability_.data(), alias_.data(), size(), u); }

 private:
  std::vector<float> probability_;
  std::vector<std::uint32_t> alias_;
};

}  // namespace lucerna
