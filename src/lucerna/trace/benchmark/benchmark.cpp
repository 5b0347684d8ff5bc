// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/benchmark/benchmark.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {

namespace {

class PillowMirror final : public HeightSurface {
 public:
  PillowMirror(double focal_mm, double pillow_mm) : f_(4.0 * focal_mm), p_(pillow_mm) {}
  SurfacePoint at(double x, double y) const override {
    const double cx = std::cos(k_ * x), cy = std::cos(k_ * y), sx = std::sin(k_ * x), sy = std::sin(k_ * y);
    return {(x * x + y * y) / f_ + p_ * cx * cy, 2.0 * x / f_ - p_ * k_ * sx * cy,
            2.0 * y / f_ - p_ * k_ * cx * sy};
  }
  HeightRange range(const Rectangle& r) const override {
    const RadiusRange q = radius_range(r);
    return {q.min_mm * q.min_mm / f_ - p_, q.max_mm * q.max_mm / f_ + p_};
  }

 private:
  double f_, p_, k_ = 2.0 * std::numbers::pi / 8.0;
};

const std::array<BenchmarkScene, 3>& all_scenes() {
  static const std::array<BenchmarkScene, 3> kScenes{
      {{"para", 15.0, 0.0}, {"wavy", 15.0, 0.4}, {"deep", 5.0, 0.4}}};
  return kScenes;
}

constexpr double kMegabyte = 1e6;

}  // namespace

std::span<const BenchmarkScene> benchmark_scenes() { return all_scenes(); }

std::shared_ptr<const RaySet> benchmark_rays(std::size_t n) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1000.0);
  set->rays.resize(n, 0);
  parallel_blocks(n, 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Rng rng(1, i);
      const double a = 2.0 * std::numbers::pi * rng.uniform(), c = 2.0 * rng.uniform() - 1.0;
      const double b = 2.0 * std::numbers::pi * rng.uniform(), s = std::sqrt(1.0 - c * c);
      set->rays.set(i, {{std::cos(a), std::sin(a), 6.0 * rng.uniform() - 3.0},
                        Direction::from_unit({s * std::cos(b), s * std::sin(b), c})});
      set->rays.weight[i] = 1.0F;
    }
  });
  return set;
}

Scene benchmark_scene(const BenchmarkScene& s, std::shared_ptr<const RaySet> rays) {
  const Reflector mirror{std::make_shared<PillowMirror>(s.focal_mm, s.pillow_mm),
                         Aperture::rectangle(100.0, 100.0)};
  PlacedSource source{std::make_shared<RaySetSource>(std::move(rays), "cylinder"),
                      Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, s.focal_mm}), std::nullopt};
  Scene scene;
  scene.sources = {std::move(source)};
  scene.reflectors = {{mirror, Frame(), Reflectance(0.9)}};
  scene.far_fields = {{"far", 1.0, 1.0}};
  return scene;
}

double wall_seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double cpu_seconds(const std::function<void()>& work) {
  timespec a{}, b{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &a);
  work();
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &b);
  return static_cast<double>(b.tv_sec - a.tv_sec) + 1e-9 * static_cast<double>(b.tv_nsec - a.tv_nsec);
}

double best_of(int times, double (*clock)(const std::function<void()>&), const std::function<void()>& work) {
  double best = 1e30;
  for (int i = 0; i < times; ++i) best = std::min(best, clock(work));
  return best;
}

double rays_per_second(const Scene& scene, const TraceOptions& options, std::uint64_t rays,
                       double (*clock)(const std::function<void()>&), TraceResult* result) {
  TraceOptions all = options, none = options;
  all.last_ray = rays;
  none.last_ray = 1;
  TraceResult traced;
  const double setup = best_of(2, clock, [&] { traced = trace(scene, none); });
  const double t = best_of(2, clock, [&] { traced = trace(scene, all); }) - setup;
  if (result != nullptr) *result = std::move(traced);
  return static_cast<double>(rays) / std::max(t, 1e-9);
}

BenchmarkMetrics run_benchmark(const BenchmarkScene& s, int cells, const std::shared_ptr<const RaySet>& rays,
                               Progress& progress) {
  const auto go_on = [&] { progress.step("bench", 0, 0); };
  const Scene scene = benchmark_scene(s, rays);
  BenchmarkMetrics f;
  f.scene = s.name;
  f.cells = cells;
  f.threads = ThreadLimit::current();
  f.rays = rays->rays.size();
  std::unique_ptr<HeightField> field;
  f.build_ms = 1e3 * wall_seconds([&] {
                 field = std::make_unique<HeightField>(scene.reflectors[0].reflector, cells);
               });
  f.update_ms = 1e3 * best_of(5, wall_seconds, [&] { field->rebuild(); });
  f.heights_mb = static_cast<double>(field->vertices().size() * sizeof(FieldVertex)) / kMegabyte;
  f.hierarchy_mb = static_cast<double>(field->nodes().size() * sizeof(FieldNode)) / kMegabyte;
  go_on();
  TraceOptions options;
  options.cells = cells;
  options.max_bounces = kBenchmarkBounces;
  TraceResult result;
  f.rays_per_s = rays_per_second(scene, options, f.rays, wall_seconds, &result);
  f.isa = result.isa;
  f.casts_per_ray = 1.0 + ledger(result).reflections_per_ray.mean;
  go_on();
  const ThreadLimit one(1);
  f.rays_per_cpu_s = rays_per_second(scene, options, f.rays, cpu_seconds);
  go_on();
  if (!EmbreeBaseline::available()) return f;
  const EmbreeBaseline embree(*field);
  std::vector<double> bins(std::size_t{360} * 181);
  const double t =
      best_of(2, cpu_seconds, [&] { embree.trace(rays->rays, s.focal_mm, kBenchmarkBounces, bins); });
  f.embree_rays_per_cpu_s = static_cast<double>(f.rays) / t;
  f.embree_build_ms = 1e3 * embree.build_s();
  go_on();
  return f;
}

}  // namespace lucerna
