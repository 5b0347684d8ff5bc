// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "lucerna/trace.h"

namespace lucerna {

/// The largest piece of a trace without a clock: a second or so of mirrors on two cores, beside which setting
/// up the tracer and adding the bins cost nothing.
inline constexpr std::uint64_t kUntimedPiece = std::uint64_t{1} << 24;

/// How many rays the next piece of a trace has. What is stopped within a piece is lost, so that pieces take
/// some seconds at most; but each sets up the tracer, which may take most of a small one. The trace is the
/// same for any pieces.
class PieceSize {
 public:
  explicit PieceSize(std::uint64_t max_rays) : max_(max_rays), rays_(std::min(max_rays, kFirst)) {}

  std::uint64_t rays() const { return rays_; }
  /// To be told of each whole piece.
  void took(double seconds);

 private:
  static constexpr std::uint64_t kFirst = std::uint64_t{1} << 18;
  std::uint64_t max_, rays_;
  double rate_ = 0.0;
};

/// `trace_rays`, which can be stopped between pieces of so many rays at most. The result is the same for any.
NoiseTrace trace_rays_in_pieces(std::uint64_t piece_rays, const Scene& scene, const TraceOptions& options,
                                std::optional<TraceResult> from, Progress& progress);

}  // namespace lucerna
