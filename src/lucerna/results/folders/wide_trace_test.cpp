// SPDX-License-Identifier: Apache-2.0
// Traces beyond 2^34 rays, of a stub in the tracer's place: its sums are known in closed form.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/math/int128.h"
#include "lucerna/results/folders/trace_file.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "lucerna/trace/tally/wide_sums.h"
#include "lucerna/trace_file.h"
#include "lucerna/trace_metrics.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kChunk = std::uint64_t{1} << 24;
constexpr std::int64_t kQuanta = std::int64_t{1} << 26;

/// What a ray of the stub deposits: a mean ray and a bit that no double of the total would keep.
constexpr std::int64_t kEach = kQuanta + 1;

/// All rays leave directly and meet the plane. With a far field, those of replicate r are in its bin r; its
/// many bins make the stub slow.
TraceResult stub_trace(std::uint64_t first, std::uint64_t last, bool far_field = true) {
  TraceResult t;
  t.first_ray = first;
  t.last_ray = last;
  t.max_bounces = 1;
  t.isa = "stub";
  t.flux = 1000.0;
  if (far_field) t.far_fields = {{"far", 5.0, 5.0}};
  t.planes = {{"floor", {Frame(), 10.0, 10.0, 2, 1}}};
  for (std::uint64_t r = 0; r < kReplicates; ++r) {
    Tally tally;
    // Blocks b of the range with b mod 16 = r; the ranges here are of whole blocks.
    const auto blocks_before = [&](std::uint64_t ray) {
      return (ray / kBlockRays + kReplicates - 1 - r) / kReplicates;
    };
    tally.rays = (blocks_before(last) - blocks_before(first)) * kBlockRays;
    tally.emitted = tally.out_direct = static_cast<std::int64_t>(tally.rays) * kEach;
    tally.absorbed.resize(kMirrorLosses);
    tally.lost.resize(kLostCauses);
    tally.lost_rays.resize(kLostCauses);
    tally.bins.push_back({0, tally.emitted});
    if (far_field) {
      tally.bins.insert(tally.bins.begin(),
                        std::vector<std::int64_t>(FarFieldGrid::counted(t.far_fields[0]).size()));
      tally.bins[0][r] = tally.emitted;
    }
    t.replicates.push_back(std::move(tally));
  }
  return t;
}

TraceResult stub_run(std::uint64_t first, std::uint64_t last, std::uint64_t chunk, bool far_field = true) {
  TraceResult sum = stub_trace(first, std::min(last, first + chunk), far_field);
  while (sum.last_ray < last)
    sum = merge(sum, stub_trace(sum.last_ray, std::min(last, sum.last_ray + chunk), far_field));
  return sum;
}

void expect_exact(const TraceResult& t, std::uint64_t rays) {
  Int128 emitted = 0, floor = 0;
  std::uint64_t counted = 0;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    const Tally& tally = t.replicates[r];
    emitted += emitted_of(tally);
    const std::size_t floor_bins = t.far_fields.size();
    floor += all_bins_of(tally, floor_bins);
    counted += tally.rays;
    EXPECT_TRUE(emitted_of(tally) == Int128{tally.rays} * kEach) << r;
    EXPECT_TRUE(bin_of(tally, floor_bins, 1) == emitted_of(tally)) << r;
    EXPECT_TRUE(bin_of(tally, floor_bins, 0) == 0) << r;
    if (t.far_fields.empty()) continue;
    EXPECT_TRUE(bin_of(tally, 0, r) == emitted_of(tally)) << r;
  }
  EXPECT_EQ(counted, rays);
  EXPECT_TRUE(emitted == Int128{rays} * kEach);
  EXPECT_TRUE(floor == emitted);
  const Ledger l = ledger(t);
  EXPECT_EQ(l.rays, rays);
  EXPECT_NEAR(l.out_direct.mean, 1000.0, 1e-9);
  EXPECT_NEAR(illuminance(t, 0).flux.mean, 1000.0, 1e-9);
  if (t.far_fields.empty()) return;
  const std::vector<double> flux = far_field(t, 0).flux;
  EXPECT_NEAR(std::accumulate(flux.begin(), flux.end(), 0.0), 1000.0, 1e-9);
}

constexpr std::uint64_t kMillionMillion = 1'000'000'000'000 / kBlockRays * kBlockRays;

TEST(WideTrace, TenToTheTwelveRaysAddExactly) {
  const TraceResult sum = stub_run(0, kMillionMillion, kChunk, false);
  expect_exact(sum, kMillionMillion);
  EXPECT_TRUE(trace_from_bytes(trace_bytes(sum)) == sum);
  const std::string json = trace_json(trace_metrics(sum)).dump();
  EXPECT_EQ(nlohmann::json::parse(json)["ledger"]["rays"].get<std::uint64_t>(), kMillionMillion);
}

// 2^43 rays: more than one lane of 64 bits holds. The bytes do not depend on where the run was cut.
TEST(WideTrace, TwoLanesGoThroughFiles) {
  constexpr std::uint64_t kRays = std::uint64_t{1} << 43, kCut = (std::uint64_t{1} << 41) + 5 * kBlockRays;
  const TraceResult sum = stub_run(0, kRays, kChunk << 12);
  EXPECT_FALSE(sum.replicates[0].high.empty());
  expect_exact(sum, kRays);
  const std::string bytes = trace_bytes(sum);
  const TraceResult read = trace_from_bytes(bytes);
  EXPECT_TRUE(read == sum);
  expect_exact(read, kRays);
  const TraceResult low = stub_run(0, kCut, kChunk << 12), high = stub_run(kCut, kRays, kChunk << 12);
  EXPECT_EQ(trace_bytes(merge(high, low)), bytes);
  const test::TempDir dir;
  const TraceOrigin origin{"id", "1", "text", 2.0, 3.0};
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directories(dir / name);
    write_trace_file(dir / name / kTraceFileName, name[0] == 'a' ? low : high, origin);
  }
  const StoredTrace merged = merge_trace_folders({dir / "b", dir / "a"});
  EXPECT_TRUE(merged.result == sum);
}

TEST(WideTrace, EveryTruncationIsRefused) {
  const std::string bytes = trace_bytes(stub_run(0, std::uint64_t{1} << 43, kChunk << 12, false));
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_THROW(trace_from_bytes(std::string_view(bytes).substr(0, n)), InputError) << n;
}

// Files of one lane keep the version that earlier programs wrote and read.
TEST(WideTrace, OrdinaryFilesAreOfTheVersionBefore) {
  const auto version = [](const TraceResult& t) { return static_cast<int>(trace_bytes(t)[8]); };
  EXPECT_EQ(version(stub_trace(0, kChunk)), 3);
  EXPECT_EQ(version(stub_run(0, std::uint64_t{1} << 43, kChunk << 12, false)), 4);
}

TEST(WideTrace, DamagedLanesAreRefused) {
  TraceResult bad = stub_run(0, std::uint64_t{1} << 43, kChunk << 12, false);
  bad.replicates[3].bins[0][0] = -1;
  EXPECT_THROW(trace_from_bytes(trace_bytes(bad)), InputError);
  bad.replicates[3].bins[0][0] = std::int64_t{1} << 32;
  EXPECT_THROW(trace_from_bytes(trace_bytes(bad)), InputError);
  bad.replicates[3].bins[0][0] = 0;
  bad.replicates[3].high[7] = std::int64_t{1} << 60;
  EXPECT_THROW(trace_from_bytes(trace_bytes(bad)), InputError);
  bad.replicates[3].high.pop_back();
  EXPECT_THROW(trace_from_bytes(trace_bytes(bad)), InputError);
  TraceResult one = stub_trace(0, kChunk);
  one.replicates[0].bins[0][0] = std::int64_t{1} << 62;
  EXPECT_THROW(trace_from_bytes(trace_bytes(one)), InputError);
}

}  // namespace
}  // namespace lucerna
