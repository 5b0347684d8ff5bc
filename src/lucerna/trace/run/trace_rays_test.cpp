// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lucerna/build_info.h"
#include "lucerna/random.h"
#include "lucerna/rays.h"
#include "lucerna/source.h"
#include "lucerna/trace/run/noise_rounds.h"
#include "lucerna/trace/run/trace_pieces.h"
#include "lucerna/version.h"

namespace lucerna {
namespace {

Scene disk() {
  Scene scene;
  scene.sources.push_back({make_emitter({.kind = EmitterKind::disk}), Frame(), std::nullopt});
  scene.far_fields = {{"far", 30.0, 10.0}};
  return scene;
}

/// The program's pieces are longer.
constexpr std::uint64_t kPiece = std::uint64_t{1} << 18;

/// Asks to stop once a ray beyond `after` was reported.
class StopAfter final : public Progress {
 public:
  explicit StopAfter(std::uint64_t after) : after_(after) {}
  void update(std::string_view, std::uint64_t done, std::uint64_t total) override {
    EXPECT_GE(done, done_);
    done_ = done;
    total_ = total;
  }
  bool stop_requested() const override { return done_ > after_; }
  std::uint64_t done_ = 0, total_ = 0;

 private:
  std::uint64_t after_;
};

TEST(TraceRays, InPiecesHasTheBitsOfOneTrace) {
  TraceOptions options;
  options.first_ray = 1000;
  options.last_ray = 3 * kPiece + 5000;
  StopAfter never(~std::uint64_t{0});
  const NoiseTrace pieces = trace_rays_in_pieces(kPiece, disk(), options, std::nullopt, never);
  EXPECT_EQ(pieces.end, NoiseEnd::rays);
  EXPECT_TRUE(pieces.result == trace(disk(), options));
  EXPECT_TRUE(pieces.result == trace_rays(disk(), options).result);
  EXPECT_EQ(never.total_, 3 * kPiece + 4000);
  EXPECT_EQ(never.done_, never.total_);
}

TEST(TraceRays, ThatAreStoppedReturnWhatWasWholeAndGoOn) {
  TraceOptions options;
  options.last_ray = 2 * kPiece + 1;
  StopAfter stop(kPiece + 1);
  const NoiseTrace part = trace_rays_in_pieces(kPiece, disk(), options, std::nullopt, stop);
  EXPECT_EQ(part.end, NoiseEnd::interrupted);
  EXPECT_EQ(part.result.last_ray, kPiece);
  EXPECT_TRUE(trace_rays(disk(), options, part.result).result == trace(disk(), options));
  StopAfter at_once(0);
  EXPECT_THROW(trace_rays(disk(), options, std::nullopt, at_once), Interrupted);
  StopAfter later(kFirstRound + 1);
  EXPECT_EQ(trace_until(disk(), {}, {.noise = 1e-9}, std::nullopt, later).end, NoiseEnd::interrupted);
}

TEST(TraceRays, RefuseWhatIsThereAlready) {
  TraceOptions options;
  options.last_ray = 5000;
  const TraceResult there = trace_rays(disk(), options).result;
  EXPECT_TRUE(trace_rays(disk(), options, there).result == there);
  options.last_ray = 4000;
  EXPECT_THROW(trace_rays(disk(), options, there), UsageError);
  options.first_ray = 4000;
  EXPECT_THROW(trace_rays(disk(), options), UsageError);
}

TEST(BuildInfo, NamesVersionAndInstructionSet) {
  const BuildInfo info = build_info();
  EXPECT_EQ(info.version, version());
  EXPECT_GE(info.threads, 1);
  TraceOptions options;
  options.last_ray = 512;
  options.isa = info.isa;
  EXPECT_EQ(trace(disk(), options).isa, trace(disk(), {.last_ray = 512}).isa);
}

// The same rays again would make errors smaller than they are.
TEST(TraceRays, RaysOfAFileCountOnce) {
  const auto set = std::make_shared<RaySet>();
  set->rays.resize(3000, 0);
  make_emitter({.kind = EmitterKind::disk})->emit(Sequence(SequenceKind::random, 1), 0, set->rays);
  set->header.set_flux(100.0);
  Scene scene = disk();
  scene.sources.front().rays = std::make_shared<RaySetSource>(set, "set");
  TraceOptions options;
  options.last_ray = 10 * 3000;
  const NoiseTrace traced = trace_rays(scene, options);
  EXPECT_EQ(traced.end, NoiseEnd::finite_source);
  EXPECT_EQ(traced.result.last_ray, 3000u);
  EXPECT_TRUE(traced.result == trace(scene, {}));
  EXPECT_TRUE(trace(scene, options) == trace(scene, {}));
  options.last_ray = 2000;
  EXPECT_EQ(trace_rays(scene, options).end, NoiseEnd::rays);
  options.first_ray = 3000, options.last_ray = 6000;
  EXPECT_THROW(trace(scene, options), UsageError);
  // A file beside a source that goes on ends the trace, too.
  scene.sources.push_back(disk().sources.front());
  options.first_ray = 0, options.last_ray = 1u << 30;
  EXPECT_EQ(trace(scene, options).last_ray, default_ray_count(scene));
}

}  // namespace
}  // namespace lucerna
