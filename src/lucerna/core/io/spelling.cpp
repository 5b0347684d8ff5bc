// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/spelling.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace lucerna {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

bool is_misspelt(std::string_view word, std::string_view meant) {
  if (edit_distance(word, meant) == 1) return true;
  const auto [a, b] = std::mismatch(word.begin(), word.end(), meant.begin(), meant.end());
  if (word.size() != meant.size() || a == word.end() || a + 1 == word.end()) return false;
  return a[0] == b[1] && a[1] == b[0] && std::equal(a + 2, word.end(), b + 2);
}

std::string nearest_word(std::string_view word, const WordSet& candidates) {
  const auto best = std::min_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  return best == candidates.end() ? std::string() : *best;
}

std::string meant_word(std::string_view word, const WordSet& candidates) {
  std::string nearest = nearest_word(word, candidates);
  if (nearest.empty() || edit_distance(word, nearest) > (word.size() + 2) / 3) return {};
  return nearest;
}

}  // namespace lucerna
