// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace lucerna {

/// When a design has to stop so that what follows the fit still fits into its time. How long that takes is
/// estimated by rays: those still to come, at the rate of those traced so far. It only stops: no decision of
/// the fit depends on it.
class TimeBudget {
 public:
  /// `rays_after`: rays that will be traced once the fit has stopped.
  TimeBudget(double time_s, std::uint64_t rays_after)
      : begin_(Clock::now()), last_(begin_), time_s_(time_s), rays_after_(static_cast<double>(rays_after)) {}

  /// To be asked between steps, with the rays traced so far and those of the next step: whether that step, at
  /// the rate of the last, would leave too little. What follows may take a third of the time at most; what
  /// then does not fit is for `affordable` to shorten.
  bool spent(std::uint64_t rays, std::uint64_t next_rays) {
    const Clock::time_point now = Clock::now();
    const double elapsed = seconds(begin_, now);
    const double traced = static_cast<double>(std::max<std::uint64_t>(rays - last_rays_, 1));
    const double step =
        rays > last_rays_ ? seconds(last_, now) / traced * static_cast<double>(next_rays) : 0.0;
    last_ = now;
    last_rays_ = rays;
    per_ray_s_ = rays > 0 ? elapsed / static_cast<double>(rays) : 0.0;
    return elapsed + step + std::min(rays_after_ * per_ray_s_, time_s_ / 3.0) > time_s_;
  }

  /// Seconds until the time is up; below 0 after it.
  double left_s() const { return time_s_ - seconds(begin_, Clock::now()); }

  /// The most of `wanted` rays (halved as often as need be, not below `min`) such that they and the
  /// `others` fit into what is left.
  std::uint64_t affordable(std::uint64_t wanted, std::uint64_t others, std::uint64_t min) const {
    const double left = left_s();
    while (wanted / 2 >= min && static_cast<double>(wanted + others) * per_ray_s_ > left) wanted /= 2;
    return wanted;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }
  Clock::time_point begin_, last_;
  std::uint64_t last_rays_ = 0;
  double time_s_, rays_after_, per_ray_s_ = 0.0;
};

}  // namespace lucerna
