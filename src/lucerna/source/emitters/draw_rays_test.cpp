// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/emitters/draw_rays.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

/// Keeps what is written.
class MemoryWriter final : public RayWriter {
 public:
  void write(const RayBlock& block) override { rays.append(block); }
  void finish() override { finished = true; }
  RayBlock rays;
  bool finished = false;
};

class StopAtOnce final : public Progress {
 public:
  void update(std::string_view, std::uint64_t, std::uint64_t) override {}
  bool stop_requested() const override { return true; }
};

TEST(DrawRays, SameBitsForOneAndTwoThreadsAndInMemoryOrStreamed) {
  const auto source = make_emitter({.kind = EmitterKind::led});
  const Sequence sequence(SequenceKind::sobol, 4);
  const std::size_t n = kStreamBlock + 12'345;
  RayBlock one, two;
  {
    const ThreadLimit limit(1);
    one = draw_rays(*source, sequence, n);
  }
  {
    const ThreadLimit limit(2);
    two = draw_rays(*source, sequence, n);
  }
  EXPECT_EQ(one, two);
  MemoryWriter writer;
  draw_rays(*source, sequence, n, writer);
  EXPECT_TRUE(writer.finished);
  double sum = 0.0;
  for (float& weight : writer.rays.weight) {
    sum += static_cast<double>(weight);
    weight = 1.0f;
  }
  EXPECT_NEAR(sum, source->flux(), 1e-4 * source->flux()) << "rays of a file carry lm";
  EXPECT_EQ(one, writer.rays);
}

TEST(DrawRays, AnInterruptLeavesTheFileUnfinished) {
  const auto source = make_emitter({.kind = EmitterKind::disk});
  const Sequence sequence(SequenceKind::random, 4);
  MemoryWriter writer;
  StopAtOnce stop;
  EXPECT_THROW(draw_rays(*source, sequence, 1000, writer, stop), Interrupted);
  EXPECT_FALSE(writer.finished);
}

}  // namespace
}  // namespace lucerna
