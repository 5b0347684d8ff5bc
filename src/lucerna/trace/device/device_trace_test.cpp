// SPDX-License-Identifier: Apache-2.0
// What a GPU will run, run by the CPU: the same kernels, launched over the same flat arrays by the same
// driver, against the CPU's own engine with the same kernels.
#include "lucerna/trace/device/device_trace.h"

#include <gtest/gtest.h>

#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/trace/device/device_scene.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "tests/support/device_scenes.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

Accelerators emulated(std::size_t n = 1) {
  Accelerators all;
  for (std::size_t i = 0; i < n; ++i) all.push_back(make_emulated_accelerator());
  return all;
}

using test::cylinder, test::expect_closed, test::expect_same, test::rays_of, test::scene_of;

const TraceOptions kScalar{.last_ray = 40000, .max_bounces = 5, .cells = 256, .isa = "scalar"};

TEST(DeviceTrace, IsTheCpusToTheBit) {
  const Scene scene = scene_of(cylinder());
  const TraceResult cpu = trace(scene, kScalar), device = trace_on(emulated(), scene, kScalar);
  expect_same(cpu, device);
  EXPECT_EQ(device.isa, "emulated");
  const Ledger l = ledger(device);
  EXPECT_GT(l.reflections_per_ray.mean, 0.5);
  EXPECT_GT(l.absorbed[1].second.mean, 0.0) << "some light must meet a back";
  EXPECT_GT(l.lost[0].second.mean, 0.0) << "some must reach the limit of reflections";
  EXPECT_GT(device.out_rays.size(), 10000u);
}

TEST(DeviceTrace, EveryFamilyIsTheCpusToTheBit) {
  for (const Reflector& family : test::families()) {
    const Scene scene = test::scene_of(cylinder(), family);
    expect_same(trace(scene, kScalar), trace_on(emulated(), scene, kScalar));
  }
}

/// `mirror` with a tilt and a reflectance over the angle, before a height field that takes part of its light.
Scene exact_scene_of(const Reflector& mirror) {
  Scene scene = scene_of(cylinder());
  scene.reflectors[0].reflector = mirror;
  scene.reflectors[0].slope_error_mrad = 2.0;
  return scene;
}

TEST(DeviceTrace, ScatteredLightIsTheCpusToTheBit) {
  const Scene plain = scene_of(cylinder());
  for (const Scene& scene : {test::with_lobes(test::with_glasses(plain)), test::with_table(plain, false),
                             test::with_table(plain, true)}) {
    const TraceResult device = trace_on(emulated(), scene, kScalar);
    expect_same(trace(scene, kScalar), device);
    expect_closed(device);
  }
}

TEST(DeviceTrace, MirrorsThatAreNoHeightFieldAreTheCpusToTheBit) {
  for (const Reflector& family : test::exact_families()) {
    for (const Scene& scene : {scene_of(cylinder(), family), exact_scene_of(family)}) {
      const TraceResult device = trace_on(emulated(), scene, kScalar);
      expect_same(trace(scene, kScalar), device);
      const Ledger l = ledger(device);
      EXPECT_GT(l.reflections_per_ray.mean, 0.1);
      EXPECT_GT(l.absorbed[0].second.mean, 0.0);
    }
  }
}

// Kernels of other widths round differently in places; rays stay together all the same.
TEST(DeviceTrace, AgreesRayByRayWithTheFastestInstructionSet) {
  for (const Reflector& family : test::families()) {
    const Scene scene = scene_of(cylinder(), family);
    TraceOptions fastest = kScalar;
    fastest.isa.clear();
    const TraceResult fast = trace(scene, fastest), device = trace_on(emulated(), scene, kScalar);
    const test::RayPairs p = test::compare_rays(fast, device);
    EXPECT_GT(p.rays, 10000u);
    EXPECT_LE(p.differ, p.rays / 5000);
    EXPECT_LT(p.max_mm, 1e-4);
    EXPECT_LT(p.max_direction, 1e-5);
    Scene moved = scene;
    moved.reflectors[0].world_from_reflector = Frame::from_axis(Direction{}, 0.0, {0, 0, -12.01});
    EXPECT_GT(test::compare_rays(trace(moved, fastest), device).differ, p.rays / 20);
  }
}

TEST(DeviceTrace, CoverGlassesAreTheCpusToTheBit) {
  std::vector<Scene> scenes{test::with_glasses(scene_of(cylinder()))};
  for (const Reflector& family : test::exact_families()) {
    scenes.push_back(test::with_glasses(exact_scene_of(family)));
  }
  for (const Scene& scene : scenes) {
    const TraceResult device = trace_on(emulated(), scene, kScalar);
    expect_same(trace(scene, kScalar), device);
    expect_closed(device);
    const Ledger l = ledger(device);
    for (std::size_t cause = kMirrorLosses; cause < l.absorbed.size(); ++cause) {
      EXPECT_GT(l.absorbed[cause].second.mean, 0.0) << l.absorbed[cause].first;
    }
    EXPECT_GT(l.lost[0].second.mean, 0.0) << "some must reach the limit of reflections";
  }
}

// A glass that no ray comes near changes the kernel, and nothing else.
TEST(DeviceTrace, TheKernelOfAllFeaturesTracesPlainScenesToTheBit) {
  const Scene plain = scene_of(cylinder());
  Scene scene = plain;
  scene.glasses = {{.aperture = Aperture::circle(1.0),
                    .world_from_glass = Frame::from_axis(Direction{}, 0.0, {0, 0, 1e6})}};
  const TraceResult a = trace_on(emulated(), plain, kScalar), b = trace_on(emulated(), scene, kScalar);
  EXPECT_TRUE(a.out_rays == b.out_rays);
  for (std::size_t r = 0; r < a.replicates.size(); ++r) {
    EXPECT_TRUE(a.replicates[r].bins == b.replicates[r].bins);
  }
}

// Embree rounds what it finds to float32, the device's tree does not: after the second reflection a few rays
// of 10^4 are more than 1e-4 mm apart.
TEST(DeviceTrace, BodiesAgreeRayByRayWithEmbree) {
  try {
    const BodyTracer there({{.mesh = test::box_mesh({1, 1, 1})}});
  } catch (const InputError& e) {
    GTEST_SKIP() << e.what();
  }
  std::vector<Scene> scenes{test::with_bodies(scene_of(cylinder()))};
  scenes.push_back(test::with_glasses(scenes.front()));
  for (const Reflector& family : test::exact_families()) {  // less light comes out of these to the bodies
    scenes.push_back(test::with_bodies(exact_scene_of(family)));
  }
  TraceOptions options = kScalar;
  options.max_bounces = 2;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    const TraceResult cpu = trace(scene, options), device = trace_on(emulated(), scene, options);
    const test::RayPairs p = test::compare_rays(cpu, device);
    std::printf("%zu of %zu rays differ, the others by at most %.2g mm and %.2g\n", p.differ, p.rays,
                p.max_mm, p.max_direction);
    EXPECT_GT(p.rays, 3000u);
    EXPECT_LE(p.differ, p.rays / 1000);
    expect_closed(device);
    const Ledger a = ledger(cpu), b = ledger(device);
    for (std::size_t cause = 0; cause < a.absorbed.size(); ++cause) {
      EXPECT_TRUE(i > 1 || cause < kMirrorLosses || b.absorbed[cause].second.mean > 0.0)
          << b.absorbed[cause].first;
      EXPECT_NEAR(a.absorbed[cause].second.mean, b.absorbed[cause].second.mean, 1e-3 * 800.0);
    }
    if (i > 0) continue;
    // A lamp whose body also hits the light that it sends is another scene.
    Scene blocked = scene;
    blocked.bodies[0].only_returning_light = false;
    EXPECT_LT(trace_on(emulated(), blocked, options).out_rays.size(), device.out_rays.size() / 2);
  }
}

TEST(DeviceTrace, TentBinsAreTheCpusToTheBit) {
  Scene scene = scene_of(cylinder());
  scene.far_fields = {{"tents", 5.0, 1.0, true}, {"hard", 15.0, 5.0}, {"whole turn", 360.0, 90.0, true}};
  expect_same(trace(scene, kScalar), trace_on(emulated(), scene, kScalar));
  scene.ray_detectors.clear();
  scene.planes.clear();
  scene.luminances.clear();
  expect_same(trace(scene, kScalar), trace_on(emulated(), scene, kScalar));
}

/// Rays of the two that are not the same within 1e-4 mm and 1e-5.
test::RayPairs against_the_fastest(const Scene& scene, int max_bounces) {
  TraceOptions scalar = kScalar, fastest = kScalar;
  scalar.max_bounces = fastest.max_bounces = max_bounces;
  fastest.isa.clear();
  return test::compare_rays(trace(scene, fastest), trace_on(emulated(), scene, scalar));
}

// The rest of those that were reflected once started beside an edge. From one reflection to the next a small
// error grows by twice the way over the radius of curvature: a few times in hollow mirrors, more on pillows.
TEST(DeviceTrace, AgreesRayByRayWithTheFastestInstructionSetOffExactMirrors) {
  for (const Reflector& family : test::exact_families()) {
    const Scene scene = scene_of(cylinder(), family);
    const test::RayPairs once = against_the_fastest(scene, 1), often = against_the_fastest(scene, 5);
    std::printf("%zu of %zu rays differ that were reflected once, %zu of %zu of all\n", once.differ,
                once.rays, often.differ, often.rays);
    EXPECT_GT(once.rays, 5000u);
    EXPECT_LE(once.differ, once.rays / 2000);
    EXPECT_LE(often.differ, often.rays / 50);
  }
}

// Two sources in one block, of a file and of an emitter, and a range that begins and ends within blocks.
TEST(DeviceTrace, SourcesShareBlocksAndRangesAreCutAnywhere) {
  Scene scene = scene_of(std::make_shared<RaySetSource>(rays_of(*cylinder(), 30000), "cylinder"));
  scene.sources.push_back({make_emitter({.kind = EmitterKind::disk}), {}, 100.0});
  TraceOptions options = kScalar;
  options.first_ray = 12345;
  options.last_ray = 47890;
  expect_same(trace(scene, options), trace_on(emulated(), scene, options));
  options.sequence = SequenceKind::random;
  expect_same(trace(scene, options), trace_on(emulated(), scene, options));
}

// Longer than a chunk of every stream, so that chunks are used again.
TEST(DeviceTrace, AnyNumberOfAcceleratorsGivesTheSameBits) {
  Scene scene = scene_of(cylinder());
  scene.reflectors.clear();
  TraceOptions options = kScalar;
  options.first_ray = 777;
  options.last_ray = 200000;
  const TraceResult one = trace_on(emulated(1), scene, options);
  EXPECT_TRUE(one.replicates == trace(scene, options).replicates);
  for (const std::size_t n : {2, 3}) expect_same(one, trace_on(emulated(n), scene, options));
}

/// A model's rays as its `sample` makes them one by one, which is what a GPU does.
template <class Model, std::size_t D>
class OneByOne final : public RaySource {
 public:
  explicit OneByOne(const Model& model) : model_(model) {}
  double flux() const override { return model_.flux(); }
  FluxUnit flux_unit() const override { return model_.flux_unit(); }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) {
      out.set(i, model_.sample(sequence.point<D>(first + i)));
      out.weight[i] = 1.0f;
    }
  }

 private:
  const Model& model_;
};

/// Where two runs differ, in mean rays of one bin or sum.
double largest_difference(const TraceResult& a, const TraceResult& b) {
  double max = 0.0;
  for (std::size_t r = 0; r < a.replicates.size(); ++r) {
    for (std::size_t d = 0; d < a.replicates[r].bins.size(); ++d) {
      for (std::size_t i = 0; i < a.replicates[r].bins[d].size(); ++i) {
        const auto difference = a.replicates[r].bins[d][i] - b.replicates[r].bins[d][i];
        max = std::max(max, std::abs(static_cast<double>(difference)) / kQuantaPerRay);
      }
    }
  }
  return max;
}

/// A model of every kind of support, map and chart, each with a small tree.
AdaptiveData all_supports(const BoundingSurface& surface) {
  AdaptiveData data;
  data.flux = 100.0;
  data.surface = surface;
  DensityTree tree;
  tree.rays = 4000.0;
  tree.nodes = {{2, 0, 16, 40}, {}, {2, 3, 48, -9}, {}, {}};
  for (std::size_t kind = 0; kind < kSupportKinds; ++kind) {
    for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
      AdaptiveLayer layer;
      layer.share = 0.5 / kSupportKinds;
      layer.support.kind = static_cast<SupportKind>(kind);
      layer.support.map = map;
      layer.support.world_from_support =
          Frame::from_axis(Direction::from({1, -2, 0.5}), 0.7, {0.3, -0.2, 0.4});
      layer.support.radius_mm = 1.3;
      layer.support.half_size_mm = {0.5, 0.8, 1.1};
      const bool turns =
          layer.support.kind == SupportKind::cylinder || layer.support.kind == SupportKind::axis;
      layer.support.twist_per_mm = turns ? 7.0 : 0.0;
      for (std::uint32_t chart = 0; chart < layer.support.charts(); ++chart) {
        AdaptiveChart c{chart, 1.0 / layer.support.charts(), {}, {tree}};
        for (std::size_t d = 0; d < 4; ++d) {
          const auto range = layer.support.range(chart, d);
          c.box.low[d] = std::max(range[0], -2.0);
          c.box.high[d] = std::min(range[1], 2.0);
        }
        layer.charts.push_back(c);
      }
      data.layers.push_back(layer);
    }
  }
  return data;
}

TEST(DeviceTrace, AdaptiveModelsAreSampledOnTheDevice) {
  for (const BoundingSurface& surface :
       {BoundingSurface{}, BoundingSurface::plane(1.0), BoundingSurface::sphere(6.0),
        BoundingSurface::cylinder(5.0, 9.0), BoundingSurface::box({5, 6, 7})}) {
    const auto model = std::make_shared<const AdaptiveModel>(all_supports(surface));
    const Scene scene = scene_of(model);
    const TraceResult device = trace_on(emulated(), scene, kScalar);
    expect_same(trace(scene_of(std::make_shared<OneByOne<AdaptiveModel, 4>>(*model)), kScalar), device);
    // The CPU draws in batches with its own sines; hardly a ray differs by a digit.
    EXPECT_LE(largest_difference(trace(scene, kScalar), device), 2.0);
    const auto accelerator = make_emulated_accelerator();
    EXPECT_FALSE(
        DeviceScene(*accelerator, scene, RayNumbering(scene.sources, 1), kScalar).has_sent_sources());
  }
}

TEST(DeviceTrace, ClusterModelsAreSampledOnTheDevice) {
  for (const EmitterKind kind : {EmitterKind::cosine, EmitterKind::disk, EmitterKind::point}) {
    const std::shared_ptr<const ClusterModel> model =
        compress_clusters(*rays_of(*make_emitter({.kind = kind}), 8000));
    const Scene scene = scene_of(model);
    expect_same(trace(scene, kScalar), trace_on(emulated(), scene, kScalar));
    const auto accelerator = make_emulated_accelerator();
    EXPECT_FALSE(
        DeviceScene(*accelerator, scene, RayNumbering(scene.sources, 1), kScalar).has_sent_sources());
  }
}

TEST(DeviceTrace, RaysWithoutFiniteNumbersAreCountedAlike) {
  auto set = rays_of(*cylinder(), 4000);
  set->rays.x_mm[17] = std::numeric_limits<float>::quiet_NaN();
  set->rays.kz[3000] = std::numeric_limits<float>::infinity();
  const Scene scene = scene_of(std::make_shared<RaySetSource>(set, "broken"));
  const TraceResult device = trace_on(emulated(), scene, kScalar);
  expect_same(trace(scene, kScalar), device);
  EXPECT_GT(ledger(device).lost_rays, 2u);
}

TEST(DeviceScene, TreesAreThoseOfTheHeightField) {
  const Scene scene = scene_of(cylinder());
  const auto accelerator = make_emulated_accelerator();
  DeviceScene device(*accelerator, scene, RayNumbering(scene.sources, 1), kScalar);
  const auto expect_nodes = [&](const HeightField& field) {
    const std::vector<FieldNode> nodes = device.nodes(0);
    ASSERT_EQ(nodes.size(), field.nodes().size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      ASSERT_EQ(nodes[i].a, field.nodes()[i].a) << i;
      ASSERT_EQ(nodes[i].b, field.nodes()[i].b) << i;
      ASSERT_EQ(nodes[i].c, field.nodes()[i].c) << i;
      ASSERT_EQ(nodes[i].e, field.nodes()[i].e) << i;
    }
    EXPECT_EQ(device.band(0).low_mm, field.band().low_mm);
    EXPECT_EQ(device.band(0).high_mm, field.band().high_mm);
  };
  HeightField field(scene.reflectors[0].reflector, kScalar.cells);
  expect_nodes(field);
  for (std::size_t i = 0; i < field.vertices().size(); ++i) {
    field.vertices()[i].z_mm += 0.1F * static_cast<float>(i % 7);
  }
  field.rebuild();
  device.set_vertices(0, field.vertices());
  expect_nodes(field);
}

TEST(DeviceTrace, CudaWithoutADeviceIsAnErrorAndAutomaticTracesOnTheCpu) {
  if (!cuda_accelerators().empty()) GTEST_SKIP() << "there is a CUDA device";
  const Scene scene = scene_of(cylinder());
  EXPECT_FALSE(cuda_unavailable_reason().empty());
  EXPECT_EQ(cuda_unavailable_reason().find('\n'), std::string::npos);
  EXPECT_THROW(trace(scene, {.last_ray = 5000, .cells = 64, .device = TraceDevice::cuda}), InputError);
  const TraceResult on_cpu = trace(scene, {.last_ray = 5000, .cells = 64});
  const TraceResult automatic =
      trace(scene, {.last_ray = 5000, .cells = 64, .device = TraceDevice::automatic});
  EXPECT_EQ(automatic.isa, on_cpu.isa);
  expect_same(on_cpu, automatic);
}

class StopAtOnce final : public Progress {
 public:
  void update(std::string_view, std::uint64_t, std::uint64_t) override {}
  bool stop_requested() const override { return true; }
};

TEST(DeviceTrace, StopsWhenAsked) {
  StopAtOnce progress;
  EXPECT_THROW(trace_on(emulated(2), scene_of(cylinder()), kScalar, progress), Interrupted);
}

}  // namespace
}  // namespace lucerna
