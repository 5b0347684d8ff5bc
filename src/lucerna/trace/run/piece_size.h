// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace lucerna {

/// How many rays the next piece of a trace has. What is stopped within a piece is lost, so that pieces take
/// some seconds at most; but each sets up the tracer, which may take most of a small one. The trace is the
/// same for any pieces.
class PieceSize {
 public:
  explicit PieceSize(std::uint64_t max_rays) : max_(max_rays), rays_(std::min(max_rays, kFirst)) {}

  std::uint64_t rays() const { return rays_; }

  /// To be told of each whole piece.
  void took(double seconds) {
    constexpr double kShort_s = 0.5, kLong_s = 2.0, kFaster = 1.25;
    const double rate = static_cast<double>(rays_) / std::max(seconds, 1e-9);
    // A larger piece that was that much faster was mostly set up.
    if (seconds < kLong_s || rate > kFaster * rate_)
      rays_ = std::min(max_, (seconds < kShort_s ? 4 : 2) * rays_);
    rate_ = rate;
  }

 private:
  static constexpr std::uint64_t kFirst = std::uint64_t{1} << 20;
  std::uint64_t max_, rays_;
  double rate_ = 0.0;
};

}  // namespace lucerna
