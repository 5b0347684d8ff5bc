// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/device/device_trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/device/device_scene.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Numbers of a ray that the CPU sends: start, direction, weight.
constexpr std::size_t kSentColumns = 7;

/// Ray numbers [first, last) and the blocks that hold them.
struct Range {
  std::uint64_t first = 0, last = 0;
  std::uint64_t first_block() const { return first / kBlockRays; }
  std::uint64_t end_block() const { return (last + kBlockRays - 1) / kBlockRays; }
};

/// Progress of all accelerators together; the first that is told to stop stops all.
class SharedProgress {
 public:
  SharedProgress(Progress& progress, std::uint64_t total) : progress_(progress), total_(total) {}
  void add(std::uint64_t rays) {
    const std::lock_guard lock(mutex_);
    done_ += rays;
    progress_.step("trace", done_, total_);
  }

 private:
  Progress& progress_;
  std::mutex mutex_;
  std::uint64_t done_ = 0, total_;
};

/// The rays that left in one accelerator's range.
struct ChunkRays {
  RayBlock rays;
  std::vector<OutRun> runs;
};

/// What one stream works with: one chunk of blocks at a time.
class Chunk {
 public:
  Chunk(Accelerator& accelerator, int stream, const Scene& scene, const DeviceScene& device,
        const RayNumbering& numbering)
      : accelerator_(accelerator),
        stream_(stream),
        scene_(scene),
        device_(device),
        numbering_(numbering),
        max_rays_(accelerator.chunk_blocks() * kBlockRays) {
    const std::size_t max_blocks = accelerator.chunk_blocks(), max_runs = max_blocks * scene.sources.size();
    const auto both = [&](std::size_t bytes) {
      return Pair{AcceleratorBuffer(accelerator, bytes), AcceleratorBuffer(accelerator, bytes, true)};
    };
    run_begin_ = both((max_blocks + 1) * sizeof(std::uint32_t));
    runs_ = both(max_runs * sizeof(RunView));
    if (device.has_sent_sources()) sent_ = both(kSentColumns * max_rays_ * sizeof(float));
    if (!scene.ray_detectors.empty()) out_ = both(max_rays_ * sizeof(OutRay));
  }

  /// Draws what the CPU draws of blocks [first, end) and starts the rest on the accelerator.
  void start(std::uint64_t first, std::uint64_t end, const Range& range) {
    first_block_ = first;
    blocks_ = static_cast<std::uint32_t>(end - first);
    find_runs(range);
    LaunchView v = device_.view();
    v.first_block = first;
    v.blocks = blocks_;
    v.run_begin = send<std::uint32_t>(run_begin_, blocks_ + 1);
    v.runs = send<RunView>(runs_, run_begin()[blocks_]);
    if (device_.has_sent_sources()) {
      draw(v.sequence);
      v.sent = sent_view(send<float>(sent_, kSentColumns * max_rays_));
    }
    if (retains_rays()) {
      v.out_rays = out_.device.as<OutRay>();
      accelerator_.fill(stream_, v.out_rays, 0xff, rays_at_max() * sizeof(OutRay));
    }
    accelerator_.trace(stream_, v);
    if (retains_rays()) {
      accelerator_.download(stream_, out_.host.as<void>(), v.out_rays, rays_at_max() * sizeof(OutRay));
    }
  }

  /// Waits for the chunk that was started, if any, and takes what it kept. Returns its rays.
  std::uint64_t finish(ChunkRays& retained) {
    if (blocks_ == 0) return 0;
    accelerator_.wait(stream_);
    std::uint64_t rays = 0;
    for (std::uint32_t r = 0; r < run_begin()[blocks_]; ++r) rays += runs()[r].count;
    if (retains_rays()) take_rays(retained);
    blocks_ = 0;
    return rays;
  }

 private:
  struct Pair {
    AcceleratorBuffer device, host;
  };

  std::uint32_t* run_begin() { return run_begin_.host.as<std::uint32_t>(); }
  RunView* runs() { return runs_.host.as<RunView>(); }
  bool retains_rays() const { return out_.host.bytes() > 0; }
  std::size_t rays_at_max() const { return blocks_ * kBlockRays; }

  template <class T>
  const T* send(const Pair& pair, std::size_t n) {
    if (n > 0) accelerator_.upload(stream_, pair.device.as<void>(), pair.host.as<void>(), n * sizeof(T));
    return pair.device.as<const T>();
  }

  void find_runs(const Range& range) {
    std::uint32_t n = 0;
    for (std::uint32_t b = 0; b < blocks_; ++b) {
      run_begin()[b] = n;
      const std::uint64_t begin = (first_block_ + b) * kBlockRays;
      const std::uint64_t from = std::max(begin, range.first), to = std::min(begin + kBlockRays, range.last);
      for (const SourceRun& run : numbering_.runs(from, to)) {
        runs()[n++] = {run.first, run.sequence_seed, static_cast<std::uint32_t>(run.source),
                       static_cast<std::uint32_t>(run.count)};
      }
    }
    run_begin()[blocks_] = n;
  }

  SentRays sent_view(const float* base) const {
    const auto column = [this, base](std::size_t c) { return base + c * max_rays_; };
    return {column(0), column(1), column(2), column(3), column(4), column(5), column(6)};
  }

  /// Runs of sources that the CPU draws, into the columns of the chunk.
  void draw(SequenceKind kind) {
    float* const base = sent_.host.as<float>();
    parallel_blocks(blocks_, 8, [&](std::size_t first, std::size_t last) {
      RayBlock rays;
      for (std::size_t b = first; b < last; ++b) {
        std::size_t place = b * kBlockRays;
        for (std::uint32_t r = run_begin()[b]; r < run_begin()[b + 1]; ++r) {
          const RunView& run = runs()[r];
          if (device_.is_sent(run.source)) {
            rays.resize(run.count, 0);
            scene_.sources[run.source].rays->emit(Sequence(kind, run.sequence_seed), run.first, rays);
            const std::array<const std::vector<float>*, kSentColumns> columns{
                &rays.x_mm, &rays.y_mm, &rays.z_mm, &rays.kx, &rays.ky, &rays.kz, &rays.weight};
            for (std::size_t c = 0; c < kSentColumns; ++c) {
              std::copy(columns[c]->begin(), columns[c]->end(), base + c * max_rays_ + place);
            }
          }
          place += run.count;
        }
      }
    });
  }

  void take_rays(ChunkRays& retained) {
    const OutRay* const out = out_.host.as<OutRay>();
    for (std::uint32_t b = 0; b < blocks_; ++b) {
      const OutRay* ray = out + b * kBlockRays;
      for (std::uint32_t r = run_begin()[b]; r < run_begin()[b + 1]; ++r) {
        const std::uint32_t before = static_cast<std::uint32_t>(retained.rays.size());
        for (std::uint32_t i = 0; i < runs()[r].count; ++i, ++ray) {
          if (!std::isnan(ray->weight)) append(*ray, retained.rays);
        }
        const std::uint32_t left = static_cast<std::uint32_t>(retained.rays.size()) - before;
        if (left > 0) retained.runs.push_back({first_block_ + b, runs()[r].source, left});
      }
    }
  }

  static void append(const OutRay& ray, RayBlock& to) {
    to.x_mm.push_back(ray.x);
    to.y_mm.push_back(ray.y);
    to.z_mm.push_back(ray.z);
    to.kx.push_back(ray.kx);
    to.ky.push_back(ray.ky);
    to.kz.push_back(ray.kz);
    to.weight.push_back(ray.weight);
  }

  Accelerator& accelerator_;
  int stream_;
  const Scene& scene_;
  const DeviceScene& device_;
  const RayNumbering& numbering_;
  std::size_t max_rays_;
  Pair run_begin_, runs_, sent_, out_;
  std::uint64_t first_block_ = 0;
  std::uint32_t blocks_ = 0;
};

/// Traces a range on one accelerator, of no more rays than sums of one lane hold; adds its sums to
/// `replicates` and its rays to `retained`.
void trace_range(Accelerator& accelerator, const Scene& scene, const RayNumbering& numbering,
                 const TraceOptions& options, const Range& range, std::vector<Tally>& replicates,
                 ChunkRays& retained, SharedProgress& progress) {
  const DeviceScene device(accelerator, scene, numbering, options);
  std::vector<Chunk> chunks;
  for (int s = 0; s < Accelerator::kStreams; ++s)
    chunks.emplace_back(accelerator, s, scene, device, numbering);
  std::size_t next = 0;
  const std::uint64_t step = accelerator.chunk_blocks();
  for (std::uint64_t block = range.first_block(); block < range.end_block(); block += step) {
    // The oldest chunk comes first, so kept rays are in the order of their numbers.
    Chunk& chunk = chunks[next++ % chunks.size()];
    progress.add(chunk.finish(retained));
    chunk.start(block, std::min(block + step, range.end_block()), range);
  }
  for (std::size_t i = 0; i < chunks.size(); ++i)
    progress.add(chunks[next++ % chunks.size()].finish(retained));
  device.add_to(replicates);
}

}  // namespace

void run_on(const Accelerators& accelerators, const Scene& scene, const RayNumbering& numbering,
            const TraceOptions& options, TraceResult& result, Progress& progress) {
  const std::size_t n = accelerators.size();
  LUCERNA_CHECK(n > 0, "no accelerators");
  const std::uint64_t blocks = Range{result.first_ray, result.last_ray}.end_block() -
                               Range{result.first_ray, result.last_ray}.first_block();
  SharedProgress shared(progress, result.last_ray - result.first_ray);
  std::vector<ChunkRays> retained(n);
  std::vector<std::vector<Tally>> replicates(n, result.replicates);
  std::vector<std::exception_ptr> failed(n);
  const auto work = [&](std::size_t i) {
    const auto border = [&](std::size_t part) {
      const std::uint64_t block = result.first_ray / kBlockRays + blocks * part / n;
      return std::clamp(block * kBlockRays, result.first_ray, result.last_ray);
    };
    const Range range{border(i), i + 1 == n ? result.last_ray : border(i + 1)};
    if (range.first >= range.last) return;
    try {
      // A device's sums have one lane: they are fetched before they could be full.
      for (std::uint64_t at = range.first, end = 0; at < range.last; at = end) {
        end = std::min(range.last, (at / kBlockRays + kMaxRaysOfOneLane / kBlockRays) * kBlockRays);
        trace_range(*accelerators[i], scene, numbering, options, {at, end}, replicates[i], retained[i],
                    shared);
      }
    } catch (...) {
      failed[i] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < n; ++i) threads.emplace_back(work, i);
  work(0);
  for (std::thread& t : threads) t.join();
  for (const std::exception_ptr& e : failed) {
    if (e) std::rethrow_exception(e);
  }
  for (std::size_t i = 0; i < n; ++i) {
    // Each began with the (empty) sums of `result`.
    for (std::size_t r = 0; r < result.replicates.size(); ++r) result.replicates[r] += replicates[i][r];
    result.out_rays.append(retained[i].rays);
    result.out_runs.insert(result.out_runs.end(), retained[i].runs.begin(), retained[i].runs.end());
  }
}

}  // namespace lucerna
