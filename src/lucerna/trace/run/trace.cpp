// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/device/device_trace.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/engines/trace_engine.h"
#include "lucerna/trace/run/empty_trace.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Blocks of one replicate that a thread takes at a time: 262 k rays, so that clearing and adding bins is
/// cheap beside them.
constexpr std::uint64_t kTaskBlocks = 512;
/// A task is a row of blocks of one replicate; rows are aligned to ray 0, so that the cut does not depend on
/// the range.
constexpr std::uint64_t kRowRays = kTaskBlocks * kReplicates * kBlockRays;

/// The rays that left in one task, with what puts them into the order of their numbers.
struct RetainedRays {
  RayBlock rays;
  std::vector<OutRun> runs;
};

/// Joins the rays of all tasks of `trace`: every row of tasks holds its blocks by replicate.
void order_rays(const std::vector<RetainedRays>& tasks, TraceResult& result) {
  std::size_t total = 0;
  for (const RetainedRays& task : tasks) total += task.rays.size();
  result.out_rays.reserve(total);
  std::uint64_t block = result.first_ray / kRowRays * kTaskBlocks * kReplicates;
  for (std::size_t row = 0; row < tasks.size(); row += kReplicates) {
    std::array<std::size_t, kReplicates> next{}, at{};
    for (std::uint64_t k = 0; k < kTaskBlocks * kReplicates; ++k, ++block) {
      const std::size_t r = k % kReplicates;
      const RetainedRays& task = tasks[row + r];
      for (; next[r] < task.runs.size() && task.runs[next[r]].block == block; ++next[r]) {
        const OutRun& run = task.runs[next[r]];
        for (std::uint32_t i = 0; i < run.rays; ++i) result.out_rays.append(task.rays, at[r]++);
        result.out_runs.push_back(run);
      }
    }
  }
}

}  // namespace

TraceDevice trace_device(std::string_view name) {
  if (name == "cpu") return TraceDevice::cpu;
  if (name == "cuda") return TraceDevice::cuda;
  if (name == "auto") return TraceDevice::automatic;
  throw UsageError(fmt::format("unknown device '{}'; expected auto, cpu or cuda", name));
}

std::uint64_t default_ray_count(const Scene& scene) {
  check(scene);
  return RayNumbering(scene.sources, 0).default_count();
}

namespace {

/// All of a result but what comes of tracing.
TraceResult empty_result(const Scene& scene, const RayNumbering& numbering, const TraceOptions& options) {
  TraceResult result;
  result.first_ray = options.first_ray;
  result.last_ray = numbering.last_ray(options.last_ray);
  if (!(result.first_ray < result.last_ray && result.last_ray <= kMaxRays)) {
    const std::uint64_t asked = options.last_ray.value_or(result.last_ray);
    const bool file_ends = result.last_ray < asked;
    throw UsageError(fmt::format("rays {}:{}: expected first < last <= {}{}", result.first_ray, asked,
                                 file_ends ? result.last_ray : kMaxRays,
                                 file_ends ? ", all that the ray files have" : ""));
  }
  if (options.max_bounces < 1)
    throw UsageError(fmt::format("{} bounces: expected at least 1", options.max_bounces));
  result.seed = options.seed;
  result.sequence = options.sequence;
  result.max_bounces = options.max_bounces;
  result.unit = scene.sources.front().rays->flux_unit();
  result.flux = total_flux(scene.sources);
  result.far_fields = scene.far_fields;
  for (const Body& b : scene.bodies) result.body_names.push_back(b.name);
  for (const CoverGlass& g : scene.glasses) result.body_names.push_back(g.name);
  for (const Solid& s : scene.solids) result.body_names.push_back(s.name);
  result.planes = scene.planes;
  result.luminances = scene.luminances;
  result.ray_detectors = scene.ray_detectors;
  return result;
}

Tally empty_tally(const Scene& scene) {
  Tally empty;
  empty.absorbed.resize(kMirrorLosses + scene.bodies.size() + scene.glasses.size() + scene.solids.size());
  empty.lost.resize(kLostCauses);
  empty.lost_rays.resize(kLostCauses);
  for (const FarFieldDetector& d : scene.far_fields) empty.bins.emplace_back(FarFieldGrid::counted(d).size());
  for (const PlaneDetector& d : scene.planes) empty.bins.emplace_back(d.grid.size());
  for (const LuminanceDetector& d : scene.luminances) empty.bins.emplace_back(d.grid.size());
  return empty;
}

/// The accelerators that `options` ask for; none: the CPU traces.
Accelerators chosen_accelerators(const TraceOptions& options) {
  if (options.device == TraceDevice::cpu) return {};
  const bool must = options.device == TraceDevice::cuda;
  if (options.engine == EngineKind::reference || !options.isa.empty()) {
    if (must) throw UsageError("the reference engine and chosen instruction sets are the CPU's");
    return {};
  }
  Accelerators devices = cuda_accelerators();
  if (must) require_cuda();
  return devices;
}

TraceResult trace_on_cpu(const Scene& scene, const RayNumbering& numbering, const TraceOptions& options,
                         Progress& progress);

}  // namespace

TraceResult empty_trace(const Scene& scene, const TraceOptions& options) {
  check(scene);
  TraceResult result = empty_result(scene, RayNumbering(scene.sources, options.seed), options);
  result.isa = options.isa;
  result.replicates.assign(kReplicates, empty_tally(scene));
  return result;
}

TraceResult trace(const Scene& scene, const TraceOptions& options, Progress& progress) {
  check(scene);
  const Accelerators devices = chosen_accelerators(options);
  if (!devices.empty()) return trace_on(devices, scene, options, progress);
  return trace_on_cpu(scene, RayNumbering(scene.sources, options.seed), options, progress);
}

TraceResult trace_on(const Accelerators& accelerators, const Scene& scene, const TraceOptions& options,
                     Progress& progress) {
  check(scene);
  const RayNumbering numbering(scene.sources, options.seed);
  TraceResult result = empty_result(scene, numbering, options);
  result.isa = accelerators.front()->isa();
  result.replicates.assign(kReplicates, empty_tally(scene));
  run_on(accelerators, scene, numbering, options, result, progress);
  return result;
}

namespace {

TraceResult trace_on_cpu(const Scene& scene, const RayNumbering& numbering, const TraceOptions& options,
                         Progress& progress) {
  TraceResult result = empty_result(scene, numbering, options);
  const bool keep_rays = !scene.ray_detectors.empty();
  const auto engine = options.engine == EngineKind::reference
                          ? make_reference_engine(scene, numbering, options)
                          : make_wavefront_engine(scene, numbering, options);
  result.isa = engine->isa();
  result.replicates.assign(kReplicates, engine->empty_tally());
  std::mutex mutex;
  std::uint64_t done = 0;
  const std::uint64_t first_row = result.first_ray / kRowRays;
  const std::uint64_t rows = (result.last_ray - 1) / kRowRays + 1 - first_row;
  std::vector<RetainedRays> retained(keep_rays ? rows * kReplicates : 0);
  parallel_blocks(rows * kReplicates, 1, [&](std::size_t task, std::size_t) {
    const std::uint64_t replicate = task % kReplicates;
    const std::uint64_t row_begin = (first_row + task / kReplicates) * kRowRays;
    Tally tally = engine->empty_tally();
    TraceScratch scratch;
    std::vector<OutRun> out_runs;
    for (std::uint64_t k = 0; k < kTaskBlocks; ++k) {
      const std::uint64_t begin = row_begin + (k * kReplicates + replicate) * kBlockRays;
      const std::uint64_t from = std::max(begin, result.first_ray);
      const std::uint64_t to = std::min(begin + kBlockRays, result.last_ray);
      if (from >= to) continue;
      for (const SourceRun& run : numbering.runs(from, to)) {
        const std::size_t before = scratch.out_rays.size();
        engine->trace_run(run, scratch, tally);
        const auto left = static_cast<std::uint32_t>(scratch.out_rays.size() - before);
        if (left > 0) {
          out_runs.push_back({begin / kBlockRays, static_cast<std::uint32_t>(run.source), left});
        }
      }
    }
    const std::lock_guard lock(mutex);
    if (keep_rays) retained[task] = {std::move(scratch.out_rays), std::move(out_runs)};
    result.replicates[replicate] += tally;
    done += tally.rays;
    progress.step("trace", done, result.last_ray - result.first_ray);
  });
  order_rays(retained, result);
  return result;
}

}  // namespace

}  // namespace lucerna
