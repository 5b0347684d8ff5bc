// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// Puts the items for which `below(item)` is true first; returns how many. Items in the wrong half are noted
/// in blocks from both ends and changed for one another: no branch hangs on where an item is.
template <class Below>
std::size_t split_items(std::span<TreeItem> items, const Below& below) {
  constexpr std::size_t kBlock = 128;
  std::array<std::uint8_t, kBlock> wrong_left, wrong_right;
  std::size_t first = 0, last = items.size(), lefts = 0, rights = 0, left_at = 0, right_at = 0;
  while (last - first >= 2 * kBlock) {
    if (lefts == 0) {
      left_at = 0;
      for (std::size_t i = 0; i < kBlock; ++i) {
        wrong_left[lefts] = static_cast<std::uint8_t>(i);
        lefts += below(items[first + i]) ? 0u : 1u;
      }
    }
    if (rights == 0) {
      right_at = 0;
      for (std::size_t i = 0; i < kBlock; ++i) {
        wrong_right[rights] = static_cast<std::uint8_t>(i);
        rights += below(items[last - 1 - i]) ? 1u : 0u;
      }
    }
    const std::size_t n = std::min(lefts, rights);
    for (std::size_t k = 0; k < n; ++k) {
      std::swap(items[first + wrong_left[left_at + k]], items[last - 1 - wrong_right[right_at + k]]);
    }
    left_at += n, lefts -= n;
    right_at += n, rights -= n;
    if (lefts == 0) first += kBlock;
    if (rights == 0) last -= kBlock;
  }
  // What is left: those above wait in an array.
  std::array<TreeItem, 2 * kBlock> above;
  std::size_t middle = first, waiting = 0;
  for (std::size_t i = first; i < last; ++i) {
    const TreeItem item = items[i];
    items[middle] = above[waiting] = item;
    const std::size_t low = below(item) ? 1 : 0;
    middle += low, waiting += 1 - low;
  }
  std::copy_n(above.begin(), waiting, items.begin() + static_cast<std::ptrdiff_t>(middle));
  return middle;
}

}  // namespace lucerna
