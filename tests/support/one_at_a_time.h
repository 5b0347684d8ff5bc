// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

#include "lucerna/progress.h"

namespace lucerna::test {

/// Counts the calls that came while another one had not returned, and the counts that fell: Progress promises
/// neither of them. Each call takes a millisecond, so that they would meet.
class OneAtATime : public Progress {
 public:
  void update(std::string_view, std::uint64_t done, std::uint64_t) override {
    if (inside_.exchange(true)) ++overlaps;
    if (done < seen_.exchange(done)) ++falls;
    ++calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    inside_ = false;
  }
  bool stop_requested() const override { return false; }

  std::atomic<int> calls{0}, overlaps{0}, falls{0};

 private:
  std::atomic<bool> inside_{false};
  std::atomic<std::uint64_t> seen_{0};
};

}  // namespace lucerna::test
