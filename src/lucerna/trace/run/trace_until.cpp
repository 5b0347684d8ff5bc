// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/trace.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/result/node_noise.h"
#include "lucerna/trace/run/noise_rounds.h"
#include "lucerna/trace/run/piece_size.h"
#include "lucerna/trace/run/trace_pieces.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// The most that is traced between two looks at the clock: a fraction of a second of mirrors on two cores.
constexpr std::uint64_t kTimedPiece = std::uint64_t{1} << 22;

/// Reports the rays of a trace in pieces as those of one.
class PieceProgress final : public Progress {
 public:
  PieceProgress(Progress& all, std::uint64_t before, std::uint64_t total)
      : all_(all), before_(before), total_(total) {}
  void update(std::string_view phase, std::uint64_t done, std::uint64_t) override {
    all_.update(phase, before_ + done, total_);
  }
  bool stop_requested() const override { return all_.stop_requested(); }

 private:
  Progress& all_;
  std::uint64_t before_, total_;
};

/// Adds rays up to `last` to a trace, in pieces; stops early when `stop()`. False if progress stopped it,
/// which is an error where there is no whole piece.
template <class Stop>
bool trace_on_to(std::uint64_t last, PieceSize& size, const Scene& scene, TraceOptions options,
                 std::optional<TraceResult>& sum, const Stop& stop, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  std::uint64_t at = sum ? sum->last_ray : options.first_ray;
  // Rays that an accelerator keeps cannot be added to others.
  const bool whole = options.device != TraceDevice::cpu && !scene.ray_detectors.empty();
  while (at < last) {
    options.first_ray = at;
    options.last_ray = at = whole ? last : std::min(last, at + size.rays());
    const std::uint64_t begin = sum ? sum->first_ray : options.first_ray;
    PieceProgress of_all(progress, options.first_ray - begin, last - begin);
    const auto start = Clock::now();
    try {
      TraceResult piece = trace(scene, options, of_all);
      sum = sum ? merge(*sum, piece) : std::move(piece);
    } catch (const Interrupted&) {
      if (!sum) throw;
      return false;
    }
    size.took(std::chrono::duration<double>(Clock::now() - start).count());
    if (stop()) return true;
  }
  return true;
}

bool never() { return false; }

}  // namespace

std::string_view to_string(NoiseEnd end) {
  switch (end) {
    case NoiseEnd::reached:
      return "";
    case NoiseEnd::time:
      return "the time was over first";
    case NoiseEnd::rays:
      return "the rays were used up first";
    case NoiseEnd::finite_source:
      return "a ray file has given all its rays; a model of it would have more";
    case NoiseEnd::no_goal:
      return "no noise to go by without a far field, or with rays to keep";
    case NoiseEnd::interrupted:
      return "interrupted";
  }
  return "";
}

NoiseTrace trace_until(const Scene& scene, const TraceOptions& options, const NoiseGoal& goal,
                       std::optional<TraceResult> from, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  TraceOptions run = options;
  if (from) {
    run.first_ray = from->first_ray;
    run.seed = from->seed;
    run.sequence = from->sequence;
  }
  const std::uint64_t once = default_ray_count(scene);
  NoiseTrace out{{}, std::nan(""), NoiseEnd::no_goal};
  std::optional<TraceResult> sum = std::move(from);
  PieceSize size(goes_by_noise(scene) ? kTimedPiece : kUntimedPiece);
  if (!goes_by_noise(scene)) {
    out.end = end_without_noise(scene);
    if (!trace_on_to(once, size, scene, run, sum, never, progress)) out.end = NoiseEnd::interrupted;
  } else {
    const auto late = [&] {
      return std::chrono::duration<double>(Clock::now() - start).count() >= goal.max_seconds;
    };
    const auto rays = [&] { return sum ? sum->last_ray - sum->first_ray : 0; };
    for (;;) {
      const std::uint64_t round = sum ? next_round(rays()) : kFirstRound;
      // A trace that was stopped within a round is evaluated at the round's end only, as it would have been.
      if (sum && is_round(rays())) {
        out.noise = node_noise(*sum);
        if (good_enough(*sum, out.noise, goal.noise)) {
          out.end = NoiseEnd::reached;
          break;
        }
      }
      out.end = NoiseEnd::rays;
      if (rays() >= std::min(goal.max_rays, kMaxRays)) break;
      out.end = NoiseEnd::time;
      if (sum && late()) break;
      const std::uint64_t first = sum ? sum->first_ray : run.first_ray;
      const std::uint64_t last = first + std::min({round, goal.max_rays, kMaxRays - first});
      if (trace_on_to(last, size, scene, run, sum, late, progress)) continue;
      out.end = NoiseEnd::interrupted;
      break;
    }
  }
  if (!sum) throw UsageError("no rays to trace");
  if (std::isnan(out.noise) || out.end != NoiseEnd::reached) out.noise = node_noise(*sum);
  if (out.end == NoiseEnd::finite_source && out.noise <= goal.noise) out.end = NoiseEnd::reached;
  out.result = std::move(*sum);
  return out;
}

NoiseTrace trace_rays(const Scene& scene, const TraceOptions& options, std::optional<TraceResult> from,
                      Progress& progress) {
  return trace_rays_in_pieces(kUntimedPiece, scene, options, std::move(from), progress);
}

NoiseTrace trace_rays_in_pieces(std::uint64_t piece_rays, const Scene& scene, const TraceOptions& options,
                                std::optional<TraceResult> from, Progress& progress) {
  TraceOptions run = options;
  check(scene);
  const std::uint64_t last = RayNumbering(scene.sources, 0).last_ray(options.last_ray);
  if (from) {
    if (options.first_ray != from->first_ray || last < from->last_ray) {
      throw UsageError(fmt::format("rays {}:{} asked for, rays {}:{} are there already", options.first_ray,
                                   last, from->first_ray, from->last_ray),
                       "rays");
    }
    run.seed = from->seed;
    run.sequence = from->sequence;
  }
  const bool file_ends = options.last_ray.value_or(last) > last;
  NoiseTrace out{{}, std::nan(""), file_ends ? NoiseEnd::finite_source : NoiseEnd::rays};
  std::optional<TraceResult> sum = std::move(from);
  PieceSize size(piece_rays);
  if (!trace_on_to(last, size, scene, run, sum, never, progress)) out.end = NoiseEnd::interrupted;
  if (!sum) throw UsageError(fmt::format("no rays to trace: {}:{}", run.first_ray, last), "rays");
  out.result = std::move(*sum);
  return out;
}

}  // namespace lucerna
