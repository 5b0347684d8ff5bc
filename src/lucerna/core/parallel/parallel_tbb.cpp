// SPDX-License-Identifier: Apache-2.0
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

using oneapi::tbb::global_control;

struct ThreadLimit::Control {
  global_control tbb;
};

ThreadLimit::ThreadLimit(int threads)
    : control_(new Control{global_control(global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(std::max(1, threads)))}) {}

ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::current() {
  return static_cast<int>(global_control::active_value(global_control::max_allowed_parallelism));
}

void detail::run_tasks(std::size_t n, void (*task)(const void*, std::size_t), const void* context) {
  oneapi::tbb::parallel_for(
      std::size_t{0}, n, [=](std::size_t i) { task(context, i); }, oneapi::tbb::simple_partitioner());
}

}  // namespace lucerna
