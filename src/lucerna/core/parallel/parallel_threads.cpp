// SPDX-License-Identifier: Apache-2.0
// Threads that are started for each loop and joined at its end: slower than a pool, but all of it is compiled
// with the program, so that the thread sanitizer sees every start and every end.
#include <atomic>
#include <exception>
#include <thread>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Never fewer than four to begin with: races are to be found on small machines too.
std::atomic<int>& thread_limit() {
  static std::atomic<int> limit{std::max(4, static_cast<int>(std::thread::hardware_concurrency()))};
  return limit;
}

/// Threads beside the callers', of all loops together: as many of `wanted` as are free now.
class ExtraThreads {
 public:
  explicit ExtraThreads(std::size_t wanted) {
    int before = busy().load();
    do {
      const int free = std::max(0, thread_limit().load() - 1 - before);
      count_ = std::min(wanted, static_cast<std::size_t>(free));
    } while (!busy().compare_exchange_weak(before, before + static_cast<int>(count_)));
  }
  ~ExtraThreads() { busy() -= static_cast<int>(count_); }
  ExtraThreads(const ExtraThreads&) = delete;
  ExtraThreads& operator=(const ExtraThreads&) = delete;
  std::size_t count() const { return count_; }

 private:
  static std::atomic<int>& busy() {
    static std::atomic<int> threads{0};
    return threads;
  }
  std::size_t count_ = 0;
};

}  // namespace

struct ThreadLimit::Control {
  int before;
};

ThreadLimit::ThreadLimit(int threads) : control_(new Control{current()}) {
  thread_limit() = std::min(std::max(1, threads), control_->before);
}

ThreadLimit::~ThreadLimit() { thread_limit() = control_->before; }

int ThreadLimit::current() { return thread_limit(); }

// Neighbours in number go to different threads, whoever is free: a race between them is there in every run.
void detail::run_tasks(std::size_t n, void (*task)(const void*, std::size_t), const void* context) {
  const ExtraThreads extra(n > 1 ? n - 1 : 0);
  const std::size_t threads = extra.count() + 1;
  std::vector<std::exception_ptr> errors(threads);
  const auto run = [&](std::size_t t) {
    try {
      for (std::size_t i = t; i < n; i += threads) task(context, i);
    } catch (...) {
      errors[t] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < threads; ++t) others.emplace_back(run, t);
  run(0);
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace lucerna
