// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace lucerna {

// What runs the loops is the choice of the build (CMake: LUCERNA_PARALLEL): oneTBB (parallel_tbb.cpp), or
// plain threads (parallel_threads.cpp) under the thread sanitizer, which cannot see into a TBB that it did
// not compile.

/// Caps the worker threads of every parallel loop while it lives (1 = serial); of several, the smallest
/// counts. To be destroyed in the reverse order of construction. Results never depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  /// The threads that a loop started now may use.
  static int current();

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

namespace detail {

/// Calls `task(context, i)` for each i < n, in any order on any thread. An exception of one of them reaches
/// the caller; others may then not be called.
void run_tasks(std::size_t n, void (*task)(const void* context, std::size_t i), const void* context);

template <class Task>
void run_tasks(std::size_t n, const Task& task) {
  run_tasks(
      n, [](const void* context, std::size_t i) { (*static_cast<const Task*>(context))(i); }, &task);
}

}  // namespace detail

/// Number of blocks of at most `block` items that `n` items make.
constexpr std::size_t block_count(std::size_t n, std::size_t block) { return (n + block - 1) / block; }

/// Calls `body(first, last)` for [0, n) cut into blocks of `block` items, in any order on any thread. The cut
/// depends on `n` and `block` alone, so whatever is computed per block is the same for any number of threads.
template <class Body>
void parallel_blocks(std::size_t n, std::size_t block, const Body& body) {
  detail::run_tasks(block_count(n, block),
                    [&](std::size_t i) { body(i * block, std::min(n, (i + 1) * block)); });
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

/// Calls both, in any order or at once, and returns when both are done.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  detail::run_tasks(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

}  // namespace lucerna
