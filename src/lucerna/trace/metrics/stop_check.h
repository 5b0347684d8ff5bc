// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "lucerna/progress.h"

namespace lucerna {

/// Asks a Progress from several threads whether the work shall end: one call at a time, as Progress promises.
/// Thread safe; the Progress must outlive it.
class StopCheck {
 public:
  explicit StopCheck(const Progress& progress) : progress_(progress) {}

  /// Throws Interrupted once the caller wants the work to end.
  void operator()() const {
    const std::lock_guard lock(mutex_);
    if (progress_.stop_requested()) throw Interrupted();
  }

 private:
  const Progress& progress_;
  mutable std::mutex mutex_;
};

/// Never wants the work to end.
inline const StopCheck& no_stop() {
  static const StopCheck none(no_progress());
  return none;
}

}  // namespace lucerna
