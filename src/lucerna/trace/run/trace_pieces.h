// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "lucerna/trace.h"

namespace lucerna {

/// The largest piece of a trace without a clock: a second or so of mirrors on two cores, beside which setting
/// up the tracer and adding the bins cost nothing.
inline constexpr std::uint64_t kUntimedPiece = std::uint64_t{1} << 24;

/// `trace_rays`, which can be stopped between pieces of so many rays at most. The result is the same for any.
NoiseTrace trace_rays_in_pieces(std::uint64_t piece_rays, const Scene& scene, const TraceOptions& options,
                                std::optional<TraceResult> from, Progress& progress);

}  // namespace lucerna
