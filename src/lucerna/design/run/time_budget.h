// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "lucerna/core/parallel/peers.h"

namespace lucerna {

/// When a design has to stop so that what follows the search still fits into its time. It only stops: no
/// decision of a search depends on it. With peers the clock of the first process counts for `spent`, which is
/// collective then.
class TimeBudget {
 public:
  explicit TimeBudget(double time_s, Peers* peers = nullptr)
      : peers_(peers), begin_(Clock::now()), search_(begin_), last_(begin_), time_s_(time_s) {}

  /// To be called where the search begins: what will follow it, in seconds, and in rays at the rate of the
  /// search's own.
  void begin_search(double seconds_after, std::uint64_t rays_after) {
    search_ = last_ = Clock::now();
    seconds_after_ = seconds_after;
    rays_after_ = static_cast<double>(rays_after);
  }

  /// To be asked between steps, with the rays traced so far and those of the next step: whether that step, at
  /// the rate of the last, would leave too little. What follows may take a third of the time at most.
  bool spent(std::uint64_t rays, std::uint64_t next_rays) {
    const Clock::time_point now = Clock::now();
    const double traced = static_cast<double>(std::max<std::uint64_t>(rays - last_rays_, 1));
    const double step =
        rays > last_rays_ ? seconds(last_, now) / traced * static_cast<double>(next_rays) : 0.0;
    last_ = now;
    last_rays_ = rays;
    per_ray_s_ = rays > 0 ? seconds(search_, now) / static_cast<double>(rays) : 0.0;
    const double after = std::min(seconds_after_ + rays_after_s(), time_s_ / 3.0);
    return of_first(peers_, seconds(begin_, now) + step + after > time_s_);
  }

  /// Seconds that the rays after the search will take; 0 before it has traced any.
  double rays_after_s() const { return rays_after_ * per_ray_s_; }

  /// Seconds until the time is up, by the own clock; below 0 after it.
  double left_s() const { return time_s_ - seconds(begin_, Clock::now()); }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }
  Peers* peers_;
  Clock::time_point begin_, search_, last_;
  std::uint64_t last_rays_ = 0;
  double time_s_, seconds_after_ = 0.0, rays_after_ = 0.0, per_ray_s_ = 0.0;
};

}  // namespace lucerna
