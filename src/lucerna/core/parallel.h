// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lucerna {

/// Caps the worker threads of every parallel loop while it lives (1 = serial). Results never depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(oneapi::tbb::global_control::max_allowed_parallelism,
                 static_cast<std::size_t>(std::max(1, threads))) {}

  /// The threads that a loop started now may use.
  static int current() {
    return static_cast<int>(
        oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism));
  }

 private:
  oneapi::tbb::global_control control_;
};

/// Number of blocks of at most `block` items that `n` items make.
constexpr std::size_t block_count(std::size_t n, std::size_t block) { return (n + block - 1) / block; }

/// Calls `body(first, last)` for [0, n) cut into blocks of `block` items, in any order on any thread. The cut
/// depends on `n` and `block` alone, so whatever is computed per block is the same for any number of threads.
template <class Body>
void parallel_blocks(std::size_t n, std::size_t block, const Body& body) {
  oneapi::tbb::parallel_for(
      std::size_t{0}, block_count(n, block),
      [&](std::size_t i) { body(i * block, std::min(n, (i + 1) * block)); },
      oneapi::tbb::simple_partitioner());
}

/// `body(first, last)` returns a T per block; the T are returned in the order of the blocks. Summing them in
/// that order gives the same bits for any number of threads.
template <class T, class Body>
std::vector<T> parallel_map_blocks(std::size_t n, std::size_t block, const Body& body) {
  std::vector<T> results(block_count(n, block));
  parallel_blocks(n, block,
                  [&](std::size_t first, std::size_t last) { results[first / block] = body(first, last); });
  return results;
}

}  // namespace lucerna
