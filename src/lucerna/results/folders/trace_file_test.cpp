// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_file.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

TraceResult small_trace(std::uint64_t first, std::uint64_t last) {
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0));
  const Frame placed = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15});
  Scene scene;
  scene.sources = {{make_emitter({.kind = EmitterKind::cylinder}), {}, std::nullopt}};
  scene.reflectors = {{mirror, placed, Reflectance(0.9)}};
  scene.far_fields = {{"far", 30.0, 10.0}};
  scene.planes = {{"floor", {placed, 500.0, 400.0, 7, 5}}};
  scene.luminances = {{"view", {placed, 50.0, 40.0, 3, 4}, 5.0},
                      {"eye", {placed, 50.0, 40.0, 3, 4}, 5.0, 300.0, 20.0}};
  scene.ray_detectors = {{"rays", "speos"}};
  return trace(scene, {.first_ray = first, .last_ray = last, .cells = 64});
}

TEST(TraceFile, BytesHoldATraceToTheBit) {
  const TraceResult traced = small_trace(0, 9000);
  const std::string bytes = trace_bytes(traced);
  EXPECT_TRUE(trace_from_bytes(bytes) == traced);
  EXPECT_THROW(trace_from_bytes(bytes.substr(0, bytes.size() / 2)), InputError);
  const test::TempDir dir;
  write_file(dir / kTraceFileName, bytes);
  EXPECT_TRUE(read_trace(dir.path()) == traced);
}

TEST(TraceFile, WhatIsReadIsWhatWasWrittenAndRangesAdd) {
  const test::TempDir dir;
  write_trace_file(dir / "a", small_trace(0, 9000), {"id", "1", "text", 2.0, 3.0});
  write_trace_file(dir / "b", small_trace(9000, 20000), {"id", "1", "text", 2.0, 3.0});
  const StoredTrace a = read_trace_file(dir / "a"), b = read_trace_file(dir / "b");
  const TraceOrigin origin{"id", "1", "text", 2.0, 3.0};
  EXPECT_EQ(a.origin, origin);
  const TraceResult whole = small_trace(0, 20000), sum = merge(a.result, b.result);
  EXPECT_EQ(sum.replicates, whole.replicates);
  EXPECT_EQ(sum.planes, whole.planes);
  EXPECT_EQ(far_field(sum, 0).flux, far_field(whole, 0).flux);
  EXPECT_EQ(sum.luminances, whole.luminances);
  EXPECT_EQ(sum.out_rays, whole.out_rays);
  EXPECT_EQ(sum.ray_detectors, whole.ray_detectors);
  EXPECT_EQ(luminance(sum, 0).value, luminance(whole, 0).value);
}

// The fuzz target trace goes farther; this much also runs under the sanitizers, in minutes.
TEST(TraceFileFuzz, DamagedFilesAreRefusedOrSane) {
  const test::TempDir dir;
  write_trace_file(dir / "good", small_trace(0, 3000), {"id", "1", "text", 2.0, 3.0});
  const std::string good = read_file(dir / "good", 1 << 24);
  EXPECT_THROW(read_trace_file(dir / "none"), InputError);
  for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 100) {
    write_file(dir / "cut", good.substr(0, n));
    EXPECT_THROW(read_trace_file(dir / "cut"), InputError) << n;
  }
  Rng rng(1, 0);
  for (int i = 0; i < 300; ++i) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) bad[rng.bits() % bad.size()] = static_cast<char>(rng.bits());
    write_file(dir / "bad", bad);
    try {
      const StoredTrace t = read_trace_file(dir / "bad");
      ledger(t.result);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace lucerna
