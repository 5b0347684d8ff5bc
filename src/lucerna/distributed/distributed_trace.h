// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/distributed/partial_trace.h"
#include "lucerna/distributed/ranks.h"
#include "lucerna/progress.h"

namespace lucerna {

/// Traces a range of rays: `trace`, or a stub in tests.
using RangeTracer = std::function<TraceResult(const RayInterval& rays, Progress& progress)>;

struct DistributedOptions {
  /// Where ranks leave their parts; all of them see the same folder, which is made when there is a part.
  std::filesystem::path parts;
  /// Rays that a rank takes at a time, a multiple of 512; 0: as many as keep all ranks busy to the end, 2^24
  /// at most. The result does not depend on it.
  std::uint64_t chunk_rays = 0;
  /// Seconds between two writings of a rank's part.
  double checkpoint_s = 300.0;
  /// On the first rank: a finished trace to go on with, which begins at the run's first ray. Elsewhere, and
  /// where there is none, null.
  const TraceResult* from = nullptr;
  /// Told by the first rank, for people.
  std::function<void(const std::string&)> note = [](const std::string&) {};
};

struct DistributedTrace {
  /// On the first rank, where the run came to its end: what `trace` returns, to the bit.
  std::optional<TraceResult> result;
  /// Asked to stop: what each rank had is in its part.
  bool interrupted = false;
};

/// Traces the rays that `empty` (empty_trace.h) names, by all ranks together; collective. Rays are dealt by a
/// counter that all ranks share, so that none waits for another. Parts that an earlier run of any number of
/// ranks has left are gone on with; a damaged one is told of and its rays are traced again. The parts are
/// left, for the caller to remove once the result is written. Throws InputError, the same on all ranks, if
/// the ranks or the parts are not of one program version, scene, seed and tracer. Memory: that of a trace and
/// one more tally, on the first rank twice the kept rays.
DistributedTrace trace_on_ranks(Ranks& ranks, const TraceResult& empty, const RangeTracer& tracer,
                                const TraceOrigin& origin, const DistributedOptions& options,
                                Progress& progress = no_progress());

struct DistributedNoise {
  /// On the first rank, where the run came to its end.
  std::optional<NoiseTrace> result;
  /// As DistributedTrace::interrupted.
  bool interrupted = false;
};

/// `trace_until` by all ranks together; collective. The rounds are those of one process, and the first rank
/// looks at the noise after each and tells the others: unless the time ends it, the result is that of one
/// process for any number of ranks, to the bit. Time is seconds on the clock of any rank, looked at between
/// chunks once the first round is whole; what was dealt by then is finished. `empty` names the first ray; its
/// last one is not looked at. Parts and `options.from` are gone on with at the end of the round that they
/// reach into. Memory: that of `trace_on_ranks` and one more tally.
DistributedNoise trace_until_on_ranks(Ranks& ranks, const Scene& scene, TraceResult empty,
                                      const RangeTracer& tracer, const TraceOrigin& origin,
                                      const DistributedOptions& options, const NoiseGoal& goal,
                                      Progress& progress = no_progress());

/// The instruction set that all ranks have: the least of the best ones of each. Collective.
std::string common_isa(Ranks& ranks, const std::string& best);

/// The best instruction set of this processor that the tracer has.
std::string best_isa();

}  // namespace lucerna
