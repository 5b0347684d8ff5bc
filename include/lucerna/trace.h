// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/detectors.h"
#include "lucerna/estimate.h"
#include "lucerna/flux_unit.h"
#include "lucerna/progress.h"
#include "lucerna/random.h"
#include "lucerna/rays.h"
#include "lucerna/scene.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Why light ended on a mirror.
enum class MirrorLoss { face, back };
/// Why the tracer gave a ray up.
enum class LostCause {
  bounce_limit,  ///< still inside after TraceOptions::max_bounces reflections
  not_finite,    ///< a coordinate became infinite or not a number
};
/// Number of MirrorLoss values.
inline constexpr std::size_t kMirrorLosses = 2;
/// Number of LostCause values.
inline constexpr std::size_t kLostCauses = 2;

/// The sums of the rays of one replicate. Flux is in whole units of 2^-26 of a mean ray, so that sums do not
/// depend on the order of adding.
struct Tally {
  /// Rays that were traced.
  std::uint64_t rays = 0;
  /// Reflections of all of them.
  std::uint64_t reflections = 0;
  /// Flux of these rays.
  std::int64_t emitted = 0;
  /// What left without and after being reflected (a cover glass or a solid that lets light through does not
  /// count).
  std::int64_t out_direct = 0, out_reflected = 0;
  /// By cause: kMirrorLosses, then one per body, one per cover glass, one per solid.
  std::vector<std::int64_t> absorbed;
  /// By cause: kLostCauses; and how many rays that were.
  std::vector<std::int64_t> lost;
  /// How many rays that were, by cause.
  std::vector<std::uint64_t> lost_rays;
  /// One array of bins per detector: far fields, planes, luminances.
  std::vector<std::vector<std::int64_t>> bins;
  /// Empty while every sum of flux above is below 2^62, about 2^36 rays. Beyond that each is two lanes, high
  /// * 2^32 + low with low from 0 to 2^32 - 1: the low ones stand above, the high ones here, in the order
  /// emitted, out_direct, out_reflected, absorbed, lost, bins.
  std::vector<std::int64_t> high;

  /// Adds another tally of the same scene. Exact for any number of rays that a trace may have.
  Tally& operator+=(const Tally& other);
  friend bool operator==(const Tally&, const Tally&) = default;
};

/// The rays of one source in one block of 512 numbers that left; runs ascend by (block, source), so that the
/// kept rays of two ranges join to the order of one run, also where the cut is within a block.
struct OutRun {
  /// Number of the block, of the source in the scene, and how many rays left.
  std::uint64_t block = 0;
  std::uint32_t source = 0, rays = 0;
  friend bool operator==(const OutRun&, const OutRun&) = default;
};

/// What a trace leaves: raw sums by replicate, before any normalisation, so that ranges of rays can be added.
struct TraceResult {
  /// The rays traced, [first_ray, last_ray).
  std::uint64_t first_ray = 0, last_ray = 0;
  /// Of the random numbers.
  std::uint64_t seed = 0;
  /// Where the numbers of the rays came from.
  SequenceKind sequence = SequenceKind::sobol;
  /// Reflections after which a ray was given up.
  int max_bounces = 0;
  /// Which tracer and instruction set made the sums: only equal ones can be merged.
  std::string isa;
  /// Flux of all sources together.
  double flux = 0.0;
  /// lm or W.
  FluxUnit unit = FluxUnit::lumen;
  /// The detectors of the scene, in its order.
  std::vector<FarFieldDetector> far_fields;
  std::vector<PlaneDetector> planes;
  std::vector<LuminanceDetector> luminances;
  std::vector<RayDetector> ray_detectors;
  /// Causes of absorption after the mirrors': bodies, then cover glasses, then solids.
  std::vector<std::string> body_names;
  /// kReplicates tallies.
  std::vector<Tally> replicates;
  /// If the scene has ray detectors: where rays left and where to, in the order of `out_runs`. Together they
  /// carry ledger().out_direct + out_reflected; weights are in mean rays.
  RayBlock out_rays;
  /// How many of them came from which source and block.
  std::vector<OutRun> out_runs;
  friend bool operator==(const TraceResult&, const TraceResult&) = default;
};

/// Where the light went. Every figure in the unit of the sources' flux. A standard error is NaN where it is
/// not known: fewer than two replicates have rays.
struct Ledger {
  /// lm or W.
  FluxUnit unit = FluxUnit::lumen;
  /// Exactly the flux of the sources.
  double emitted = 0.0;
  /// What left without and after being reflected.
  Estimate out_direct, out_reflected;
  /// By cause: "mirror" (what its face kept), "mirror_back", then the bodies, the cover glasses and the
  /// solids.
  std::vector<std::pair<std::string, Estimate>> absorbed;
  /// By cause: "bounce_limit", "not_finite"; rays beside it.
  std::vector<std::pair<std::string, Estimate>> lost;
  /// All causes together.
  Estimate all_lost;
  /// Rays that were given up.
  std::uint64_t lost_rays = 0;
  /// All rays, and their mean number of reflections.
  std::uint64_t rays = 0;
  /// Mean number of reflections of a ray.
  Estimate reflections_per_ray;
};

/// The figures of the energy ledger. emitted = out + absorbed + lost to rounding of the last digit.
[[nodiscard]] Ledger ledger(const TraceResult& result);

/// Flux by far-field cell, numbered as in FarFieldGrid: c * gamma_count + g.
struct FarField {
  /// Of the detector.
  std::string name;
  /// Steps and numbers of the cells.
  double c_step_deg = 0.0, gamma_step_deg = 0.0;
  /// How many there are of each.
  std::size_t c_count = 0, gamma_count = 0;
  /// FarFieldDetector::tent.
  bool tent = false;
  /// lm or W.
  FluxUnit unit = FluxUnit::lumen;
  /// Flux of each cell.
  std::vector<double> flux;
  /// NaN where not known, as in Ledger.
  std::vector<double> standard_error;
};

/// A figure by cell of a plane grid, numbered iy * nx + ix.
struct PlaneImage {
  /// Of the detector.
  std::string name;
  /// The cells.
  PlaneGrid grid;
  /// lm or W.
  FluxUnit unit = FluxUnit::lumen;
  /// Illuminance in lx, or luminance in cd/m2 (W/m2 and W/(m2 sr) when `unit` is watt).
  std::vector<double> value;
  /// NaN where not known, as in Ledger.
  std::vector<double> standard_error;
  /// Flux of all cells, and its error.
  Estimate flux;
};

/// Illuminance on TraceResult::planes[index].
[[nodiscard]] PlaneImage illuminance(const TraceResult& result, std::size_t index);
/// Luminance in TraceResult::luminances[index]: flux over `etendue_mm2sr` of the cell.
[[nodiscard]] PlaneImage luminance(const TraceResult& result, std::size_t index);

/// Figures over all cells of a plane or luminance image. What choosing among noisy cells adds to the maximum
/// and takes off the least is corrected; of more than 2048 cells within six errors
/// of the extreme the 2048 best are looked at.
struct PlaneExtremes {
  /// In the unit of the image.
  Estimate mean, min, max;
  /// minimum over mean; absent for a dark plane.
  std::optional<Estimate> uniformity;
  /// Where the maximum is.
  std::size_t max_cell = 0;
};

/// Adds two traces of the same scene over different rays: the result is, to the bit, that of one run over
/// both, whatever the order. Throws InputError if they differ in seed, sequence, bounces, instruction set,
/// flux or detectors, or if their rays do not meet end to end (it says which rays are missing or double).
[[nodiscard]] TraceResult merge(const TraceResult& a, const TraceResult& b);

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
  /// One past the last ray, at most 2^53; absent: `default_ray_count`. No further than that where a source is
  /// a ray file: its rays count once.
  std::optional<std::uint64_t> last_ray;
  /// Of the random numbers.
  std::uint64_t seed = 1;
  /// Independent or evenly spread rays.
  SequenceKind sequence = SequenceKind::sobol;
  /// Reflections after which a ray is given up and counted as lost; at least 1.
  int max_bounces = 100;
  /// Which tracer.
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
[[nodiscard]] TraceResult trace(const Scene& scene, const TraceOptions& options,
                                Progress& progress = no_progress());

/// When `trace_until` has enough.
struct NoiseGoal {
  /// What `node_noise` shall be at most, and `peak_noise` half of it: a peak that is quoted shall be within
  /// it.
  double noise = 0.01;
  /// Seconds after which it stops with what it has; at least one round is traced.
  double max_seconds = 60.0;
  /// Rays after which it stops; at most 2^53, which is the default.
  std::uint64_t max_rays = std::uint64_t{1} << 53;
};

/// Why it stopped.
enum class NoiseEnd {
  reached,        ///< the noise is what was asked for
  time,           ///< NoiseGoal::max_seconds
  rays,           ///< NoiseGoal::max_rays
  finite_source,  ///< a ray file has given all its rays: more would be the same ones again
  no_goal,        ///< no far field to measure noise in, or kept rays that would fill the memory
  interrupted,    ///< the caller's Progress asked to stop
};
/// One sentence for people; empty for `reached`.
std::string_view to_string(NoiseEnd end);

/// What `trace_until` returns.
struct NoiseTrace {
  /// The sums of all rays traced.
  TraceResult result;
  /// node_noise of the result; NaN where it is not known.
  double noise = 0.0;
  /// Why it stopped.
  NoiseEnd end = NoiseEnd::reached;
};

/// Traces until the far fields are as good as asked for. The number of rays grows in fixed rounds (2^20 times
/// 1, 1.5, 2, 3, 4, 6, ...), and the noise after a round decides: with the same scene, seed and goal the
/// result is the same to the bit for any number of threads, unless the time stops it, and a run that is gone
/// on with (`from`) is the run that was never stopped. Finite sources are traced once; scenes without a far
/// field, and those that keep rays, are traced as `trace` does by default. `options.last_ray` is ignored, and
/// with `from` so is `first_ray`, `seed` and `sequence`. When progress asks to stop, the result is what was
/// whole, with `end` saying so. Throws as `trace`; Interrupted only where nothing was whole.
[[nodiscard]] NoiseTrace trace_until(const Scene& scene, const TraceOptions& options, const NoiseGoal& goal,
                                     std::optional<TraceResult> from = std::nullopt,
                                     Progress& progress = no_progress());

/// Traces the rays of `options` in pieces of 2^24: what `trace` returns, to the bit, but when progress asks
/// to stop, the pieces that were whole, with `end` saying so. With `from` its seed and sequence are gone on
/// with from its last ray to `options.last_ray`. Throws as `trace`, and UsageError where `from` reaches
/// beyond the last ray or begins at another one; Interrupted only where nothing was whole.
[[nodiscard]] NoiseTrace trace_rays(const Scene& scene, const TraceOptions& options,
                                    std::optional<TraceResult> from = std::nullopt,
                                    Progress& progress = no_progress());

}  // namespace lucerna
#pragma GCC visibility pop
