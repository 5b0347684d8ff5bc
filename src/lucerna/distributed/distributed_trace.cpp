// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/distributed_trace.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/distributed/reduction.h"
#include "lucerna/simd/processor.h"
#include "lucerna/trace/result/addition.h"
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
  /// Names of those that are good, the rays that they hold, and the number of this run.
  std::vector<std::string> names;
  RayIntervals done;
  std::uint64_t attempt = 1;
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
        mine_{empty, {}} {}

  DistributedTrace run() {
    agree_on_scene();
    const Earlier earlier = read_earlier();
    own_part_ = part_path(options_.parts, earlier.attempt, ranks_.rank());
    const bool interrupted = trace_chunks(earlier);
    if (interrupted) return {std::nullopt, true};
    add_earlier(earlier);
    return {sum_of_all(), false};
  }

 private:
  void agree_on_scene() {
    const std::string mine = origin_.program_version + " " + mine_.sums.isa + " " + origin_.scene_id;
    const std::string first = ranks_.broadcast(mine);
    agree(ranks_,
          mine == first
              ? ""
              : fmt::format("has the version, instruction set and project {}, rank 0 has {}", mine, first));
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
    check_addable(mine_.sums, stored.part.sums);
    const auto& done = stored.part.done.all();
    if (done.front().first < whole_.first || done.back().last > whole_.last) {
      throw InputError(fmt::format("{}: has rays {}:{}, this run has {}:{}", path.string(),
                                   done.front().first, done.back().last, whole_.first, whole_.last),
                       ErrorCause::mismatch);
    }
    return std::move(stored.part);
  }

  /// Every rank reads some of the parts; all learn of all. One that overlaps those before it is left out.
  Earlier read_earlier() {
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
    Earlier earlier;
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

  /// False if a rank was asked to stop. What goes wrong on one rank ends the run of all.
  bool trace_chunks(const Earlier& earlier) {
    const std::uint64_t rays = whole_.last - whole_.first;
    const auto chunks = earlier.done.missing(whole_, chosen_chunk(options_, rays, ranks_.size()));
    if (ranks_.is_first() && !earlier.names.empty()) {
      tell(fmt::format("{} of {} rays are there already, in {} parts", earlier.done.count(), rays,
                       earlier.names.size()));
    }
    bool interrupted = false;
    std::string error;
    try {
      interrupted = !trace_dealt(chunks);
      if (interrupted) {
        // Before anything that waits for others: one of them may be dead.
        checkpoint();
        ranks_.skip_numbers();
      }
    } catch (const std::exception& e) {
      error = e.what();
      ranks_.skip_numbers();
    }
    agree(ranks_, error);
    bool any = false;
    for (const std::string& one : gather_everywhere(ranks_, interrupted ? "1" : "0")) any = any || one == "1";
    try {
      if (any && !interrupted) checkpoint();
    } catch (const std::exception& e) {
      error = e.what();
    }
    agree(ranks_, error);
    return any;
  }

  /// False if asked to stop.
  bool trace_dealt(const std::vector<RayInterval>& chunks) {
    using Clock = std::chrono::steady_clock;
    auto written = Clock::now();
    for (;;) {
      if (progress_.stop_requested()) return false;
      const std::uint64_t number = ranks_.take_number();
      if (number >= chunks.size()) return true;
      try {
        ChunkProgress progress(*this, chunks, number);
        mine_.add(tracer_(chunks[number], progress));
      } catch (const Interrupted&) {
        return false;
      }
      if (std::chrono::duration<double>(Clock::now() - written).count() < options_.checkpoint_s) continue;
      checkpoint();
      written = Clock::now();
    }
  }

  void checkpoint() const {
    if (!mine_.done.empty()) write_file(own_part_, encode_part(mine_, origin_));
  }

  /// The parts of earlier runs are dealt to the ranks.
  void add_earlier(const Earlier& earlier) {
    std::string error;
    try {
      for (std::size_t i = own(0); i < earlier.names.size(); i += stride())
        mine_.add(checked_part(earlier.names[i]));
    } catch (const std::exception& e) {
      error = e.what();
    }
    agree(ranks_, error);
  }

  std::optional<TraceResult> sum_of_all() {
    const std::uint64_t rays = whole_.last - whole_.first;
    std::array<std::int64_t, 1> done{static_cast<std::int64_t>(mine_.done.count())};
    ranks_.add_to_first(done);
    add_sums_to_first(ranks_, mine_.sums, rays);
    add_rays_to_first(ranks_, mine_.sums);
    std::string error;
    if (ranks_.is_first() && static_cast<std::uint64_t>(done[0]) != rays)
      error = fmt::format("{} of {} rays were traced", done[0], rays);
    agree(ranks_, error);
    if (!ranks_.is_first()) return std::nullopt;
    return std::move(mine_.sums);
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
  PartialTrace mine_;
  fs::path own_part_;
};

constexpr std::array<const char*, 3> kIsas{"portable", "avx2", "avx512"};

}  // namespace

DistributedTrace trace_on_ranks(Ranks& ranks, const TraceResult& empty, const RangeTracer& tracer,
                                const TraceOrigin& origin, const DistributedOptions& options,
                                Progress& progress) {
  LUCERNA_CHECK(options.chunk_rays % kBlockRays == 0, "chunks of {} rays", options.chunk_rays);
  return RankTrace(ranks, empty, tracer, origin, options, progress).run();
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
