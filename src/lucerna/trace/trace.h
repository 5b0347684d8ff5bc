// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lucerna/core/progress.h"
#include "lucerna/core/sequence.h"
#include "lucerna/trace/scene.h"
#include "lucerna/trace/trace_result.h"

namespace lucerna {

/// `fast`: height fields sampled on a grid and traced in vectors of float32. `reference`: the exact surfaces,
/// one ray at a time in double; what the fast one is checked against.
enum class EngineKind { fast, reference };

/// `automatic`: on CUDA devices where there are some, else on the CPU.
enum class TraceDevice { cpu, cuda, automatic };

/// "cpu", "cuda" or "auto"; throws UsageError on anything else.
TraceDevice trace_device(std::string_view name);

/// How a scene is traced.
struct TraceOptions {
  /// The rays to trace, [first_ray, last_ray); by default all from 0 to the scene's own count
  /// (`default_ray_count`).
  std::uint64_t first_ray = 0;
  std::optional<std::uint64_t> last_ray;
  std::uint64_t seed = 1;
  SequenceKind sequence = SequenceKind::sobol;
  /// Reflections after which a ray is given up and counted as lost; at least 1.
  int max_bounces = 100;
  EngineKind engine = EngineKind::fast;
  /// Cells a side of the height fields of the fast engine: a power of two, 8 to 8192.
  int cells = 1024;
  /// Instruction set of the fast engine: "scalar", "portable", "avx2", "avx512"; empty = the best that the
  /// processor has.
  std::string isa;
  /// `cuda` throws InputError where there is no device.
  TraceDevice device = TraceDevice::cpu;
};

/// Rays that are traced when no number is asked for: every ray of the ray files once, and 2^20 for the other
/// sources.
std::uint64_t default_ray_count(const Scene& scene);

/// Sends rays from all sources through the mirrors into all detectors. The same scene and options give the
/// same bits for any number of threads. Rays are dealt as RayNumbering says. Progress phase: "trace", in
/// rays. Throws InputError on a bad scene (`check`), UsageError on a bad range of rays, Interrupted when
/// asked to stop. Memory: 17 times the bins of all detectors, and that once more per thread and 16.
TraceResult trace(const Scene& scene, const TraceOptions& options, Progress& progress = no_progress());

}  // namespace lucerna
