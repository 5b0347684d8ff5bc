// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/distributed_trace.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <numeric>
#include <thread>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/math/int128.h"
#include "lucerna/random.h"
#include "lucerna/results/folders/trace_file.h"
#include "lucerna/source.h"
#include "lucerna/trace/run/empty_trace.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "lucerna/trace/tally/wide_sums.h"
#include "lucerna/trace_file.h"
#include "tests/support/local_ranks.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

namespace fs = std::filesystem;

/// What the ranks of a run returned or threw.
struct Outcome {
  std::vector<DistributedTrace> traces;
  std::vector<std::string> errors;
  std::string notes;
};

using Body = std::function<DistributedTrace(Ranks& ranks)>;

Outcome on_ranks(int n, const Body& body) {
  test::LocalWorld world(n);
  Outcome out;
  out.traces.resize(static_cast<std::size_t>(n));
  out.errors.resize(out.traces.size());
  std::vector<std::thread> threads;
  for (int r = 0; r < n; ++r) {
    threads.emplace_back([&, r] {
      test::LocalRanks ranks(world, r);
      const auto at = static_cast<std::size_t>(r);
      try {
        out.traces[at] = body(ranks);
      } catch (const std::exception& e) {
        out.errors[at] = e.what();
      }
    });
  }
  for (std::thread& t : threads) t.join();
  return out;
}

/// A progress that asks to stop at its `calls`-th report.
class StopAfter final : public Progress {
 public:
  explicit StopAfter(int calls) : left_(calls) {}
  void update(std::string_view, std::uint64_t, std::uint64_t) override { --left_; }
  bool stop_requested() const override { return left_ <= 0; }

 private:
  std::atomic<int> left_;
};

Scene lamp() {
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0));
  const Frame placed = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15});
  Scene scene;
  scene.sources = {{make_emitter({.kind = EmitterKind::cylinder}), {}, std::nullopt},
                   {make_emitter({.kind = EmitterKind::disk}), {}, std::nullopt}};
  scene.reflectors = {{mirror, placed, Reflectance(0.9)}};
  scene.far_fields = {{"far", 30.0, 10.0}};
  scene.planes = {{"floor", {placed, 500.0, 400.0, 7, 5}}};
  scene.luminances = {{"view", {placed, 50.0, 40.0, 3, 4}, 5.0}};
  scene.ray_detectors = {{"rays", "tm25"}};
  return scene;
}

/// The rays of all runs: few, for the thread sanitizer takes minutes for thousands of chunks.
constexpr std::uint64_t kFirst = 100, kLast = 12'011;

class DistributedTraceTest : public testing::Test {
 protected:
  TraceOptions options(std::uint64_t first, std::uint64_t last) const {
    return {.first_ray = first, .last_ray = last, .cells = 64, .isa = "portable"};
  }
  Outcome run(int ranks, std::uint64_t chunk, int stop_after = 1 << 30, int stopped_rank = 0,
              std::uint64_t seed = 1, const TraceResult* from = nullptr) {
    TraceOptions all = options(kFirst, kLast);
    all.seed = seed;
    const TraceResult empty = empty_trace(scene_, all);
    return on_ranks(ranks, [&, all](Ranks& of) {
      const RangeTracer tracer = [&](const RayInterval& rays, Progress& progress) {
        TraceOptions o = all;
        o.first_ray = rays.first;
        o.last_ray = rays.last;
        return trace(scene_, o, progress);
      };
      StopAfter progress(of.rank() == stopped_rank ? stop_after : 1 << 30);
      DistributedOptions how{.parts = dir_.path(),
                             .chunk_rays = chunk,
                             .checkpoint_s = 1e-4,
                             .from = of.is_first() ? from : nullptr,
                             .note = {}};
      how.note = [&](const std::string& text) { notes_ += text + "\n"; };
      return trace_on_ranks(of, empty, tracer, origin_, how, progress);
    });
  }
  TraceResult whole() const { return trace(scene_, options(kFirst, kLast)); }
  std::vector<fs::path> parts() const {
    std::vector<fs::path> found;
    for (const auto& e : fs::directory_iterator(dir_.path())) found.push_back(e.path());
    return found;
  }
  void clear() const {
    for (const fs::path& p : parts()) fs::remove(p);
  }

  test::TempDir dir_;
  Scene scene_ = lamp();
  TraceOrigin origin_{"id", "1", "text", 2.0, 3.0};
  std::string notes_;
};

TEST_F(DistributedTraceTest, IsTheTraceOfOneProcessForAnyRanksAndChunks) {
  const TraceResult expected = whole();
  for (const int ranks : {1, 2, 3, 5, 8}) {
    for (const std::uint64_t chunk : {512u, 1024u, 8192u, 1u << 20}) {
      clear();
      const Outcome o = run(ranks, chunk);
      ASSERT_EQ(o.errors[0], "");
      ASSERT_TRUE(o.traces[0].result.has_value());
      EXPECT_TRUE(*o.traces[0].result == expected) << ranks << " ranks, chunks of " << chunk;
      for (int r = 1; r < ranks; ++r) EXPECT_FALSE(o.traces[static_cast<std::size_t>(r)].result.has_value());
    }
  }
}

// Stopped on a rank at a moment, again and again, with another number of ranks and other chunks each time.
TEST_F(DistributedTraceTest, GoesOnFromAnySplitToTheSameBits) {
  const TraceResult expected = whole();
  Rng rng(5, 0);
  for (int round = 0; round < 20; ++round) {
    clear();
    int stops = 0;
    for (;;) {
      const int ranks = 1 + static_cast<int>(rng.bits() % 5);
      const std::uint64_t chunk = 512u << (rng.bits() % 4);
      const bool last = ++stops > 4;
      const int after = last ? 1 << 30 : 1 + static_cast<int>(rng.bits() % 400);
      const int stopped = static_cast<int>(rng.bits() % static_cast<unsigned>(ranks));
      const Outcome o = run(ranks, chunk, after, stopped);
      ASSERT_EQ(o.errors[0], "");
      if (!o.traces[0].result) {
        EXPECT_TRUE(o.traces[0].interrupted);
        continue;
      }
      EXPECT_TRUE(*o.traces[0].result == expected) << round;
      break;
    }
  }
}

TEST_F(DistributedTraceTest, ATornPartIsToldOfAndTracedAgain) {
  const TraceResult expected = whole();
  run(2, 512, 200);
  ASSERT_FALSE(parts().empty());
  const std::string good = read_file(parts()[0], 1 << 26);
  Rng rng(7, 0);
  for (int i = 0; i < 6; ++i) {
    std::string bad = i < 3 ? good.substr(0, rng.bits() % good.size()) : good;
    if (i >= 3) bad[rng.bits() % bad.size()] ^= 1;
    clear();
    write_file(dir_ / "0001-000000.part", bad);
    notes_.clear();
    const Outcome o = run(3, 2048);
    EXPECT_TRUE(o.traces[0].result && *o.traces[0].result == expected) << i;
    EXPECT_TRUE(notes_.find("traced again") != std::string::npos) << notes_;
  }
}

TEST_F(DistributedTraceTest, APartThatIsThereTwiceCountsOnce) {
  const TraceResult expected = whole();
  run(1, 512, 200);
  ASSERT_EQ(parts().size(), 1u);
  fs::copy(parts()[0], dir_ / "0003-000009.part");
  const Outcome o = run(2, 1024);
  EXPECT_TRUE(o.traces[0].result && *o.traces[0].result == expected);
  EXPECT_TRUE(notes_.find("left out") != std::string::npos) << notes_;
}

TEST_F(DistributedTraceTest, PartsOfOtherRunsAreRefusedOnAllRanks) {
  run(2, 512, 200);
  const auto refused = [&](const std::string& why, std::uint64_t seed = 1) {
    const Outcome o = run(3, 1024, 1 << 30, 0, seed);
    for (const std::string& e : o.errors) EXPECT_TRUE(e.find(why) != std::string::npos) << e;
  };
  refused("0001-000000.part: the traces cannot be added: one has seed 1", 2);
  origin_.program_version = "2";
  refused("traced by lucerna 1, this is 2");
  origin_.program_version = "1";
  origin_.scene_id = "other";
  refused("another project");
}

TEST_F(DistributedTraceTest, GoesOnFromAFinishedTraceToTheBitsOfOneRun) {
  // The first one ends within a block.
  const TraceResult expected = whole(), first = trace(scene_, options(kFirst, 5'345));
  for (const int ranks : {1, 2, 3}) {
    clear();
    // Stopped on the way: the finished trace and the parts are gone on with.
    EXPECT_TRUE(run(ranks, 512, 30, 0, 1, &first).traces[0].interrupted);
    const Outcome o = run(ranks + 1, 1024, 1 << 30, 0, 1, &first);
    ASSERT_EQ(o.errors[0], "");
    EXPECT_TRUE(*o.traces[0].result == expected) << ranks;
    EXPECT_NE(notes_.find("rays are there already"), std::string::npos) << notes_;
  }
  // Parts of rays that the finished trace has are left out: results were written, and the run died.
  const Outcome again = run(2, 512, 1 << 30, 0, 1, &expected);
  EXPECT_TRUE(again.traces[0].result && *again.traces[0].result == expected) << again.errors[0];
}

TEST_F(DistributedTraceTest, AFinishedTraceOfOtherRaysIsRefusedOnAllRanks) {
  const TraceResult early = trace(scene_, options(0, 5000)), late = trace(scene_, options(kFirst, kLast + 1));
  for (const TraceResult* from : {&early, &late}) {
    const Outcome o = run(2, 1024, 1 << 30, 0, 1, from);
    for (const std::string& e : o.errors) EXPECT_TRUE(e.find("are there already") != std::string::npos) << e;
  }
}

/// Runs that go by the noise of a disk's bare light.
class DistributedNoiseTest : public testing::Test {
 protected:
  DistributedNoiseTest() {
    scene_.sources = {{make_emitter({.kind = EmitterKind::disk}), {}, std::nullopt}};
    scene_.far_fields = {{"far", 30.0, 10.0}};
  }
  /// What the ranks returned: that of the first, which alone has a result.
  DistributedNoise run(int ranks, std::uint64_t chunk, const NoiseGoal& goal, int stop_after = 1 << 30,
                       const TraceResult* from = nullptr) {
    const TraceOptions all{.isa = "portable"};
    const TraceResult empty = empty_trace(scene_, all);
    std::vector<DistributedNoise> found(static_cast<std::size_t>(ranks));
    const Outcome o = on_ranks(ranks, [&](Ranks& of) {
      const RangeTracer tracer = [&](const RayInterval& rays, Progress& progress) {
        TraceOptions some = all;
        some.first_ray = rays.first;
        some.last_ray = rays.last;
        return trace(scene_, some, progress);
      };
      StopAfter progress(stop_after);
      const DistributedOptions how{.parts = dir_.path(),
                                   .chunk_rays = chunk,
                                   .checkpoint_s = 1e-3,
                                   .from = of.is_first() ? from : nullptr};
      found[static_cast<std::size_t>(of.rank())] =
          trace_until_on_ranks(of, scene_, empty, tracer, {"id", "1", "text", 2.0, 3.0}, how, goal, progress);
      return DistributedTrace();
    });
    for (const std::string& e : o.errors) EXPECT_EQ(e, "");
    for (std::size_t r = 1; r < found.size(); ++r) EXPECT_FALSE(found[r].result.has_value());
    return std::move(found[0]);
  }
  NoiseTrace alone(const NoiseGoal& goal, std::optional<TraceResult> from = std::nullopt) const {
    return trace_until(scene_, {.isa = "portable"}, goal, std::move(from));
  }
  void clear() const {
    for (const auto& e : fs::directory_iterator(dir_.path())) fs::remove(e.path());
  }
  static bool same(const NoiseTrace& a, const NoiseTrace& b) {
    return a.result == b.result && a.noise == b.noise && a.end == b.end;
  }

  test::TempDir dir_;
  Scene scene_;
};

TEST_F(DistributedNoiseTest, EndsAtTheRoundAndTheBitsOfOneProcess) {
  const NoiseTrace first = alone({.noise = 0.0, .max_rays = 1 << 20});
  // Less than the first round has: a later one ends it.
  const NoiseGoal goal{.noise = 0.8 * first.noise, .max_seconds = 1e9};
  const NoiseTrace expected = alone(goal);
  ASSERT_EQ(expected.end, NoiseEnd::reached);
  ASSERT_GT(expected.result.last_ray, 1u << 20);
  for (const int ranks : {1, 2, 5}) {
    for (const std::uint64_t chunk : {0u, 1u << 18}) {
      clear();
      const DistributedNoise found = run(ranks, chunk, goal);
      ASSERT_TRUE(found.result.has_value());
      EXPECT_TRUE(same(*found.result, expected)) << ranks << " ranks, " << found.result->result.last_ray;
    }
  }
  // From the first round on, and stopped on the way.
  clear();
  EXPECT_TRUE(run(2, 1 << 16, goal, 2, &first.result).interrupted);
  const DistributedNoise on = run(3, 1 << 17, goal, 1 << 30, &first.result);
  ASSERT_TRUE(on.result.has_value());
  EXPECT_TRUE(same(*on.result, expected));
  const DistributedNoise there = run(2, 0, goal, 1 << 30, &expected.result);
  EXPECT_TRUE(there.result && same(*there.result, expected)) << "nothing is traced";
}

TEST_F(DistributedNoiseTest, StopsByRaysAndTimeWithAWholeRange) {
  const NoiseTrace expected = alone({.noise = 0.0, .max_rays = (1 << 20) + 5000});
  const DistributedNoise rays =
      run(3, 1 << 17, {.noise = 0.0, .max_seconds = 1e9, .max_rays = (1 << 20) + 5000});
  ASSERT_TRUE(rays.result.has_value());
  EXPECT_TRUE(same(*rays.result, expected)) << rays.result->result.last_ray;
  clear();
  const DistributedNoise none = run(2, 1 << 17, {.noise = 0.0, .max_seconds = 0.0});
  ASSERT_TRUE(none.result.has_value());
  EXPECT_EQ(none.result->end, NoiseEnd::time);
  EXPECT_EQ(none.result->result.last_ray, 1u << 20) << "the first round is traced whatever the time";
  clear();
  // Within a round each rank traces a chunk at least; whatever was dealt is whole.
  const DistributedNoise some =
      run(3, 1 << 12, {.noise = 0.0, .max_seconds = 0.0}, 1 << 30, &expected.result);
  ASSERT_TRUE(some.result.has_value());
  EXPECT_EQ(some.result->end, NoiseEnd::time);
  const std::uint64_t last = some.result->result.last_ray;
  EXPECT_GT(last, expected.result.last_ray);
  EXPECT_LT(last, 3u << 19);
  EXPECT_TRUE(some.result->result == trace(scene_, {.last_ray = last, .isa = "portable"})) << last;
}

TEST_F(DistributedNoiseTest, WithoutANoiseTheDefaultRaysAreTraced) {
  scene_.far_fields.clear();
  scene_.planes = {{"floor", {Frame(), 500.0, 400.0, 7, 5}}};
  const NoiseTrace expected = alone({});
  ASSERT_EQ(expected.end, NoiseEnd::no_goal);
  const DistributedNoise found = run(2, 1 << 18, {});
  ASSERT_TRUE(found.result.has_value());
  EXPECT_TRUE(found.result->result == expected.result);
  EXPECT_EQ(found.result->end, expected.end);
}

TEST_F(DistributedTraceTest, RanksOfOtherVersionsOrProjectsAreRefused) {
  const TraceResult empty = empty_trace(scene_, options(0, 5000));
  for (const bool version : {true, false}) {
    const Outcome o = on_ranks(3, [&](Ranks& of) {
      TraceOrigin origin = origin_;
      if (of.rank() == 2) (version ? origin.program_version : origin.scene_id) = "odd";
      const RangeTracer none = [](const RayInterval&, Progress&) -> TraceResult { throw InputError("ran"); };
      return trace_on_ranks(of, empty, none, origin, {.parts = dir_.path()});
    });
    for (const std::string& e : o.errors) EXPECT_TRUE(e.find("rank 2: has the version") == 0) << e;
  }
}

TEST_F(DistributedTraceTest, RanksOfOtherRaysOrSeedsAreRefusedAndLeaveNoFolder) {
  const fs::path parts = dir_ / "parts";
  for (const bool seed : {true, false}) {
    const Outcome o = on_ranks(3, [&](Ranks& of) {
      TraceResult empty = empty_trace(scene_, options(0, 5000));
      if (of.rank() == 1) (seed ? empty.seed : empty.last_ray) = 77;
      const RangeTracer none = [](const RayInterval&, Progress&) -> TraceResult { throw InputError("ran"); };
      return trace_on_ranks(of, empty, none, origin_, {.parts = parts});
    });
    for (const std::string& e : o.errors)
      EXPECT_TRUE(e.find("rank 1: has the rays, seed and sequence") == 0) << e;
  }
  EXPECT_FALSE(fs::exists(parts));
}

TEST_F(DistributedTraceTest, WhatFailsOnOneRankEndsAll) {
  const TraceResult empty = empty_trace(scene_, options(0, 1 << 20));
  const Outcome o = on_ranks(4, [&](Ranks& of) {
    const RangeTracer bad = [&](const RayInterval&, Progress&) -> TraceResult {
      throw InputError("no memory here");
    };
    return trace_on_ranks(of, empty, bad, origin_, {.parts = dir_.path(), .chunk_rays = 512});
  });
  for (const std::string& e : o.errors) EXPECT_TRUE(e.find("no memory here") != std::string::npos) << e;
}

TEST_F(DistributedTraceTest, TheLeastInstructionSetIsAgreedOn) {
  const auto agreed = [&](std::vector<std::string> best) {
    std::string isa;
    on_ranks(static_cast<int>(best.size()), [&](Ranks& of) {
      const std::string common = common_isa(of, best[static_cast<std::size_t>(of.rank())]);
      if (of.rank() == 1) isa = common;
      return DistributedTrace();
    });
    return isa;
  };
  EXPECT_EQ(agreed({"avx512", "avx512"}), "avx512");
  EXPECT_EQ(agreed({"avx512", "avx2", "avx512"}), "avx2");
  EXPECT_EQ(agreed({"portable", "avx2"}), "portable");
  EXPECT_EQ(agreed({"avx512", "sse9"}), "") << "an unknown one is refused";
}

// 2^43 rays of a stub on 5 ranks: lanes travel apart and are settled at the end; nothing is rounded.
TEST(DistributedStub, SumsBeyond63BitsAreExact) {
  constexpr std::uint64_t kRays = std::uint64_t{1} << 43, kChunk = std::uint64_t{1} << 36;
  TraceResult empty;
  empty.last_ray = kRays;
  empty.isa = "stub";
  empty.flux = 1.0;
  empty.planes = {{"floor", {Frame(), 10.0, 10.0, 2, 1}}};
  Tally zero;
  zero.absorbed.resize(kMirrorLosses);
  zero.lost.resize(kLostCauses);
  zero.lost_rays.resize(kLostCauses);
  zero.bins.emplace_back(2);
  empty.replicates.assign(kReplicates, zero);
  const RangeTracer stub = [&](const RayInterval& rays, Progress&) {
    TraceResult t = empty;
    t.first_ray = rays.first;
    t.last_ray = rays.last;
    for (Tally& tally : t.replicates) {
      tally.rays = (rays.last - rays.first) / kReplicates;
      tally.emitted = tally.out_direct = static_cast<std::int64_t>(tally.rays) << 26;
      tally.bins[0][1] = tally.emitted + 3;
    }
    return t;
  };
  const test::TempDir dir;
  const Outcome o = on_ranks(5, [&](Ranks& of) {
    return trace_on_ranks(of, empty, stub, {"id", "1", "text", 0.0, 0.0},
                          {.parts = dir.path(), .chunk_rays = kChunk, .checkpoint_s = 0.01});
  });
  ASSERT_TRUE(o.traces[0].result.has_value()) << o.errors[0];
  for (const Tally& t : o.traces[0].result->replicates) {
    EXPECT_TRUE(emitted_of(t) == Int128{kRays / kReplicates} << 26);
    EXPECT_TRUE(bin_of(t, 0, 1) == emitted_of(t) + 3 * Int128{kRays / kChunk});
    EXPECT_FALSE(t.high.empty());
  }
  EXPECT_TRUE(trace_from_bytes(trace_bytes(*o.traces[0].result)) == *o.traces[0].result);
}

}  // namespace
}  // namespace lucerna
