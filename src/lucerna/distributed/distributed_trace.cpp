// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/distributed_trace.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/distributed/reduction.h"
#include "lucerna/simd/processor.h"
#include "lucerna/trace/result/addition.h"
#include "lucerna/trace/result/node_noise.h"
#include "lucerna/trace/run/noise_rounds.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostChunkRays = std::uint64_t{1} << 24;
constexpr std::uint64_t kFewestChunkRays = std::uint64_t{1} << 20;
/// Chunks of a rank at least, so that the last ones end at about the same time.
constexpr std::uint64_t kChunksPerRank = 16;
constexpr const char* kPartEnding = ".part";

std::uint64_t chosen_chunk(const DistributedOptions& options, std::uint64_t rays, int ranks) {
  if (options.chunk_rays > 0) return options.chunk_rays;
  const std::uint64_t even = rays / (static_cast<std::uint64_t>(ranks) * kChunksPerRank);
  return std::clamp(even / kBlockRays * kBlockRays, kFewestChunkRays, kMostChunkRays);
}

/// ATTEMPT-RANK.part: a run that goes on with others never writes over their parts.
fs::path part_path(const fs::path& folder, std::uint64_t attempt, int rank) {
  return folder / fmt::format("{:04}-{:06}{}", attempt, rank, kPartEnding);
}

std::vector<std::string> part_names(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == kPartEnding) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::uint64_t attempt_of(const std::string& name) {
  std::uint64_t attempt = 0;
  std::from_chars(name.data(), name.data() + name.size(), attempt);
  return attempt;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

/// What all ranks know of the parts of earlier runs.
struct Earlier {
  /// Names of those that are good, the rays that they and the trace to go on with hold, and the number of
  /// this run.
  std::vector<std::string> names;
  RayIntervals done;
  std::uint64_t attempt = 1;
};

/// How the tracing of some chunks ended, for all ranks alike.
enum class ChunksEnd { done, time, interrupted };

/// What all ranks know of the rays that are traced.
struct Traced {
  std::uint64_t count = 0, last = 0;
};

/// One run of one rank.
class RankTrace {
 public:
  RankTrace(Ranks& ranks, const TraceResult& empty, const RangeTracer& tracer, const TraceOrigin& origin,
            const DistributedOptions& options, Progress& progress)
      : ranks_(ranks),
        whole_{empty.first_ray, empty.last_ray},
        tracer_(tracer),
        origin_(origin),
        options_(options),
        progress_(progress),
        mine_{empty, {}},
        old_{empty, {}} {}

  DistributedTrace run() {
    begin();
    if (trace_chunks(whole_.last, kNever) == ChunksEnd::interrupted) return {std::nullopt, true};
    load_earlier();
    const Traced traced = count_all();
    std::optional<TraceResult> sum = sum_of_all(std::exchange(old_, {}), traced);
    const std::uint64_t rays = whole_.last - whole_.first;
    agree(ranks_, traced.count == rays ? "" : fmt::format("{} of {} rays were traced", traced.count, rays));
    return {std::move(sum), false};
  }

  /// In rounds, until the first rank has enough.
  DistributedNoise run_rounds(const NoiseGoal& goal) {
    const Clock::time_point end = deadline(goal);
    begin();
    load_earlier();
    const std::uint64_t most = std::min(goal.max_rays, whole_.last - whole_.first);
    std::uint64_t before = earlier_.done.empty() ? 0 : earlier_.done.all().back().last - whole_.first;
    // Rays within a round are looked at when it is whole: those of rounds before were not enough.
    std::uint64_t round = before == 0 ? kFirstRound : next_round(before - 1);
    for (;;) {
      const Clock::time_point by = before < kFirstRound ? kNever : end;
      const ChunksEnd how = trace_chunks(whole_.first + std::min(round, most), by);
      if (how == ChunksEnd::interrupted) return {std::nullopt, true};
      const Traced traced = count_all();
      LUCERNA_CHECK(traced.last == whole_.first + traced.count, "{} rays up to {}", traced.count,
                    traced.last);
      NoiseTrace result;
      std::optional<TraceResult> sum = sum_of_all(old_, traced);
      if (sum) result = judged(std::move(*sum), goal, most, how == ChunksEnd::time || Clock::now() >= end);
      if (ranks_.broadcast(!sum || result.end != kGoOn ? "end" : "go on") == "end") {
        if (!sum) return {};
        return {std::move(result), false};
      }
      before = traced.count;
      round = next_round(before);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::time_point kNever = Clock::time_point::max();
  /// What a round that is followed by another ends with.
  static constexpr NoiseEnd kGoOn = NoiseEnd::no_goal;

  static Clock::time_point deadline(const NoiseGoal& goal) {
    // A year, if it is more: durations overflow.
    constexpr double kMostSeconds = 3.2e7;
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(std::clamp(goal.max_seconds, 0.0, kMostSeconds)));
  }

  /// What trace_until does with what it has, in its order.
  static NoiseTrace judged(TraceResult sum, const NoiseGoal& goal, std::uint64_t most, bool late) {
    const std::uint64_t rays = sum.last_ray - sum.first_ray;
    NoiseTrace out{std::move(sum), 0.0, kGoOn};
    out.noise = node_noise(out.result);
    if (is_round(rays) && good_enough(out.result, out.noise, goal.noise)) {
      out.end = NoiseEnd::reached;
    } else if (rays >= most) {
      out.end = NoiseEnd::rays;
    } else if (late) {
      out.end = NoiseEnd::time;
    }
    return out;
  }

  void begin() {
    agree_on_scene();
    earlier_ = read_earlier();
    own_part_ = part_path(options_.parts, earlier_.attempt, ranks_.rank());
    if (!earlier_.done.empty()) {
      const std::size_t parts = earlier_.names.size();
      tell(fmt::format("{} rays are there already{}", earlier_.done.count(),
                       parts == 0 ? "" : fmt::format(", {} parts among them", parts)));
    }
  }

  void agree_on_scene() {
    const std::string mine = origin_.program_version + " " + mine_.sums.isa + " " + origin_.scene_id;
    agree_on_same(ranks_, "version, instruction set and project", mine);
    agree_on_same(ranks_, "rays, seed and sequence",
                  fmt::format("{}:{} {} {}", whole_.first, whole_.last, mine_.sums.seed,
                              to_string(mine_.sums.sequence)));
  }

  /// Reads one part; what keeps it from being gone on with is an error, but damage is not.
  PartialTrace checked_part(const std::string& name) const {
    const fs::path path = options_.parts / name;
    StoredPart stored = read_part_file(path);
    if (stored.origin.program_version != origin_.program_version) {
      throw InputError(fmt::format("{}: was traced by lucerna {}, this is {}", path.string(),
                                   stored.origin.program_version, origin_.program_version),
                       ErrorCause::mismatch);
    }
    if (stored.origin.scene_id != origin_.scene_id) {
      throw InputError(
          fmt::format("{}: is a part of another project, or of other input files", path.string()),
          ErrorCause::mismatch);
    }
    try {
      check_addable(stored.part.sums, mine_.sums);
    } catch (const InputError& e) {
      throw InputError(fmt::format("{}: {}", path.string(), e.what()), e.cause());
    }
    const auto& done = stored.part.done.all();
    if (done.front().first < whole_.first || done.back().last > whole_.last) {
      throw InputError(fmt::format("{}: has rays {}:{}, this run has {}:{}", path.string(),
                                   done.front().first, done.back().last, whole_.first, whole_.last),
                       ErrorCause::mismatch);
    }
    return std::move(stored.part);
  }

  /// The rays of the trace that is gone on with, on all ranks; none if there is none.
  RayInterval agree_on_from() {
    std::string error;
    RayInterval rays;
    if (options_.from != nullptr) {
      const TraceResult& from = *options_.from;
      rays = {from.first_ray, from.last_ray};
      try {
        check_addable(mine_.sums, from);
      } catch (const InputError& e) {
        error = e.what();
      }
      if (rays.first != whole_.first || rays.last > whole_.last) {
        error = fmt::format("rays {}:{} asked for, rays {}:{} are there already", whole_.first, whole_.last,
                            rays.first, rays.last);
      }
    }
    agree(ranks_, error);
    std::string bytes;
    append(bytes, rays.first);
    append(bytes, rays.last);
    const std::string all = ranks_.broadcast(bytes);
    std::string_view view = all;
    rays.first = take(view);
    rays.last = take(view);
    return rays;
  }

  /// Every rank reads some of the parts; all learn of all. One that overlaps those before it is left out.
  Earlier read_earlier() {
    Earlier earlier;
    if (const RayInterval from = agree_on_from(); from.first < from.last) earlier.done.add(from);
    std::string listed;
    if (ranks_.is_first()) {
      for (const std::string& name : part_names(options_.parts)) listed += name + "\n";
    }
    const std::vector<std::string> names = lines_of(ranks_.broadcast(listed));
    std::string found, error;
    for (std::size_t i = own(0); i < names.size() && error.empty(); i += stride()) {
      try {
        found += names[i];
        const PartialTrace part = checked_part(names[i]);
        for (const RayInterval& r : part.done.all()) found += fmt::format(" {} {}", r.first, r.last);
      } catch (const InputError& e) {
        if (e.cause() == ErrorCause::mismatch) error = e.what();
        found += std::string(" !") + e.what();
      }
      found += "\n";
    }
    agree(ranks_, error);
    for (const std::string& name : names) earlier.attempt = std::max(earlier.attempt, attempt_of(name) + 1);
    for (const std::string& some : gather_everywhere(ranks_, found)) {
      for (const std::string& line : lines_of(some)) take_in(line, earlier);
    }
    return earlier;
  }

  /// A line of `read_earlier`: a name with numbers, or with what is wrong.
  void take_in(const std::string& line, Earlier& earlier) {
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string name = line.substr(0, space);
    if (space + 1 < line.size() && line[space + 1] == '!') {
      tell(fmt::format("{}; its rays are traced again", line.substr(space + 2)));
      return;
    }
    RayIntervals done;
    const char *at = line.data() + space, *const end = line.data() + line.size();
    while (at < end) {
      RayInterval r;
      at = std::from_chars(at + 1, end, r.first).ptr;
      at = std::from_chars(at + 1, end, r.last).ptr;
      done.add(r);
    }
    if (earlier.done.overlaps(done)) {
      tell(fmt::format("{}: has rays that another part has; it is left out", name));
      return;
    }
    earlier.names.push_back(name);
    earlier.done.add(done);
  }

  /// Traces what there is not yet of the rays up to `last`, until `by` at most. What goes wrong on one
  /// rank ends the run of all.
  ChunksEnd trace_chunks(std::uint64_t last, Clock::time_point by) {
    RayIntervals there = earlier_.done;
    if (traced_to_ > whole_.first) there = RayIntervals();
    const RayInterval asked{std::max(whole_.first, traced_to_), std::max(last, traced_to_)};
    const auto chunks = there.missing(asked, chosen_chunk(options_, asked.last - asked.first, ranks_.size()));
    std::string error;
    ChunksEnd end = ChunksEnd::done;
    try {
      end = trace_dealt(chunks, by);
      if (end == ChunksEnd::interrupted) {
        // Before anything that waits for others: one of them may be dead.
        checkpoint();
        ranks_.skip_numbers();
      }
    } catch (const std::exception& e) {
      error = e.what();
      ranks_.skip_numbers();
    }
    agree(ranks_, error);
    const ChunksEnd own_end = end;
    for (const std::string& one : gather_everywhere(ranks_, std::to_string(static_cast<int>(end))))
      end = std::max(end, static_cast<ChunksEnd>(one[0] - '0'));
    try {
      if (end == ChunksEnd::interrupted && own_end != end) checkpoint();
    } catch (const std::exception& e) {
      error = e.what();
    }
    agree(ranks_, error);
    if (end == ChunksEnd::interrupted) tell_of_kept_rays();
    // Every rank has taken one number more than there were chunks.
    numbers_before_ += chunks.size() + stride();
    traced_to_ = asked.last;
    return end;
  }

  /// Takes chunks until there are none, `by` is over or it is asked to stop.
  ChunksEnd trace_dealt(const std::vector<RayInterval>& chunks, Clock::time_point by) {
    const std::uint64_t earlier_last = earlier_.done.empty() ? 0 : earlier_.done.all().back().last;
    auto written = Clock::now();
    // No ray before the last one of earlier runs may be left out: chunks are dealt in order.
    bool may_end = false;
    ChunksEnd end = ChunksEnd::done;
    for (;;) {
      if (progress_.stop_requested()) return ChunksEnd::interrupted;
      if (may_end && Clock::now() >= by) {
        ranks_.skip_numbers();
        return ChunksEnd::time;
      }
      const std::uint64_t number = ranks_.take_number() - numbers_before_;
      if (number >= chunks.size()) return end;
      may_end = chunks[number].last > earlier_last;
      try {
        ChunkProgress progress(*this, chunks, number);
        mine_.add(tracer_(chunks[number], progress));
      } catch (const Interrupted&) {
        return ChunksEnd::interrupted;
      }
      if (std::chrono::duration<double>(Clock::now() - written).count() < options_.checkpoint_s) continue;
      checkpoint();
      written = Clock::now();
    }
  }

  void checkpoint() const {
    if (mine_.done.empty()) return;
    fs::create_directories(options_.parts);
    write_file(own_part_, encode_part(mine_, origin_));
  }

  /// How many rays an interrupted run leaves. Collective.
  void tell_of_kept_rays() {
    std::uint64_t rays = earlier_.done.count();
    std::string mine;
    append(mine, mine_.done.count());
    for (const std::string& one : gather_everywhere(ranks_, mine)) {
      std::string_view bytes = one;
      rays += take(bytes);
    }
    tell(fmt::format("interrupted: {} rays are traced and kept", rays));
  }

  /// The parts of earlier runs are dealt to the ranks; the first one has the trace that is gone on with.
  void load_earlier() {
    std::string error;
    try {
      if (options_.from != nullptr) old_.add(*options_.from);
      for (std::size_t i = own(0); i < earlier_.names.size(); i += stride())
        old_.add(checked_part(earlier_.names[i]));
    } catch (const std::exception& e) {
      error = e.what();
    }
    agree(ranks_, error);
  }

  Traced count_all() {
    std::string mine;
    for (const PartialTrace* part : {&mine_, &old_}) {
      append(mine, part->done.count());
      append(mine, part->done.empty() ? 0 : part->done.all().back().last);
    }
    Traced all;
    for (const std::string& one : gather_everywhere(ranks_, mine)) {
      for (std::string_view bytes = one; !bytes.empty();) {
        all.count += take(bytes);
        all.last = std::max(all.last, take(bytes));
      }
    }
    return all;
  }

  /// All rays that were traced, at the first rank; `sum` is what this one has of earlier runs. The trace that
  /// is gone on with may end within a block, whose other rays come after its.
  std::optional<TraceResult> sum_of_all(PartialTrace sum, const Traced& traced) {
    std::string error;
    try {
      sum.add(mine_);
    } catch (const std::exception& e) {
      error = e.what();
    }
    agree(ranks_, error);
    sum.sums.last_ray = sum.sums.first_ray + traced.count;
    add_sums_to_first(ranks_, sum.sums, traced.count);
    add_rays_to_first(ranks_, sum.sums);
    if (!ranks_.is_first()) return std::nullopt;
    return std::move(sum.sums);
  }

  /// Reports the chunks dealt so far as work done, and lets messages pass.
  class ChunkProgress final : public Progress {
   public:
    ChunkProgress(RankTrace& rank, const std::vector<RayInterval>& chunks, std::uint64_t number)
        : rank_(rank),
          before_(chunks[number].first - chunks[0].first),
          total_(chunks.back().last - chunks[0].first) {}
    void update(std::string_view phase, std::uint64_t done, std::uint64_t) override {
      rank_.ranks_.poll();
      rank_.progress_.update(phase, before_ + done, total_);
    }
    bool stop_requested() const override { return rank_.progress_.stop_requested(); }

   private:
    RankTrace& rank_;
    std::uint64_t before_, total_;
  };

  void tell(const std::string& text) const {
    if (ranks_.is_first()) options_.note(text);
  }
  std::size_t own(std::size_t first) const { return first + static_cast<std::size_t>(ranks_.rank()); }
  std::size_t stride() const { return static_cast<std::size_t>(ranks_.size()); }

  Ranks& ranks_;
  RayInterval whole_;
  const RangeTracer& tracer_;
  const TraceOrigin& origin_;
  const DistributedOptions& options_;
  Progress& progress_;
  /// What this rank traces, which its part has; and what it has of earlier runs.
  PartialTrace mine_, old_;
  Earlier earlier_;
  fs::path own_part_;
  /// Numbers that were taken for chunks of the rounds before, and the end of those rounds.
  std::uint64_t numbers_before_ = 0, traced_to_ = 0;
};

constexpr std::array<const char*, 3> kIsas{"portable", "avx2", "avx512"};

}  // namespace

DistributedTrace trace_on_ranks(Ranks& ranks, const TraceResult& empty, const RangeTracer& tracer,
                                const TraceOrigin& origin, const DistributedOptions& options,
                                Progress& progress) {
  LUCERNA_CHECK(options.chunk_rays % kBlockRays == 0, "chunks of {} rays", options.chunk_rays);
  return RankTrace(ranks, empty, tracer, origin, options, progress).run();
}

DistributedNoise trace_until_on_ranks(Ranks& ranks, const Scene& scene, TraceResult empty,
                                      const RangeTracer& tracer, const TraceOrigin& origin,
                                      const DistributedOptions& options, const NoiseGoal& goal,
                                      Progress& progress) {
  LUCERNA_CHECK(options.chunk_rays % kBlockRays == 0, "chunks of {} rays", options.chunk_rays);
  if (goes_by_noise(scene)) {
    empty.last_ray = kMaxRays;
    return RankTrace(ranks, empty, tracer, origin, options, progress).run_rounds(goal);
  }
  empty.last_ray = default_ray_count(scene);
  DistributedTrace traced = RankTrace(ranks, empty, tracer, origin, options, progress).run();
  DistributedNoise out{std::nullopt, traced.interrupted};
  if (!traced.result) return out;
  out.result = {std::move(*traced.result), 0.0, end_without_noise(scene)};
  out.result->noise = node_noise(out.result->result);
  if (out.result->end == NoiseEnd::finite_source && out.result->noise <= goal.noise)
    out.result->end = NoiseEnd::reached;
  return out;
}

std::string best_isa() { return has_avx512() ? kIsas[2] : has_avx2() ? kIsas[1] : kIsas[0]; }

std::string common_isa(Ranks& ranks, const std::string& best) {
  std::size_t least = kIsas.size() - 1;
  for (const std::string& isa : gather_everywhere(ranks, best)) {
    const auto found = std::find(kIsas.begin(), kIsas.end(), isa);
    if (found == kIsas.end()) throw InputError(fmt::format("instruction set '{}' is not known", isa));
    least = std::min(least, static_cast<std::size_t>(found - kIsas.begin()));
  }
  return kIsas[least];
}

}  // namespace lucerna
