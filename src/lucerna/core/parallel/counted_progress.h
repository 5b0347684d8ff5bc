// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "lucerna/progress.h"

namespace lucerna {

/// Tells a Progress what several threads have done together: one call at a time, as Progress promises, with a
/// count that only grows. Thread safe.
class CountedProgress {
 public:
  /// `phase` is a literal: it is not copied. `done` of `total` units were finished before.
  CountedProgress(Progress& progress, std::string_view phase, std::uint64_t done, std::uint64_t total)
      : progress_(progress), phase_(phase), done_(done), total_(total) {}

  void add(std::uint64_t finished) {
    const std::lock_guard lock(mutex_);
    done_ += finished;
    progress_.update(phase_, done_, total_);
  }

 private:
  Progress& progress_;
  std::string_view phase_;
  std::mutex mutex_;
  std::uint64_t done_, total_;
};

}  // namespace lucerna
