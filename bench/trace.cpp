// SPDX-License-Identifier: Apache-2.0
// Rays per second through a mirror of 100 x 100 mm, three scenes: para (f 15), wavy
// (with pillows of 0.4 mm and 8 mm pitch), deep (f 5 with pillows). Cylinder source r 1, length 6, isotropic
// from its lateral surface; reflectance 0.9, at most 4 reflections; Type C bins of one degree. Rays are in
// memory, in random order. Beside it Embree on the same grid as triangles, in packets of 16 rays; all but its
// search are our kernels. Usage: bench_trace [rays in millions = 4] [cells ... = 256 1024 2048]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/benchmark/benchmark.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/kernels/kernel.h"

namespace {

using namespace lucerna;

/// Root mean square angle between the normals of the height field and of the surface, where rays of the scene
/// hit, twice: the error of exit directions.
double exit_error_deg(const Scene& scene, int cells) {
  const Reflector& mirror = scene.reflectors[0].reflector;
  const HeightField field(mirror, cells);
  const ReferenceTracer tracer(mirror);
  RayBlock rays;
  rays.resize(20000, 0);
  scene.sources[0].rays->emit(Sequence(SequenceKind::random, 1), 0, rays);
  double squares = 0.0, n = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto hit = tracer.first_hit(scene.sources[0].world_from_source.ray(rays.ray(i)));
    if (!hit) continue;
    const SurfacePoint s = field.at(hit->point_mm.x, hit->point_mm.y);
    squares +=
        std::pow(2.0 * degrees(angle_between(hit->normal, Direction::from({-s.dzdx, -s.dzdy, 1.0}))), 2);
    n += 1.0;
  }
  return std::sqrt(squares / n);
}

/// M rays/s or a ratio; "-" where it was not measured.
std::string number_or_dash(double x) { return x > 0.0 ? fmt::format("{:.3g}", x) : "-"; }

constexpr std::array kSets{"portable", "avx2", "avx512"};

/// What is measured of one scene; rates in M rays/s, 0 where there is none.
struct Measured {
  std::array<double, kSets.size()> one_thread{};  ///< of kSets
  double all_threads = 0.0, embree = 0.0;
  double rebuild_ms = 0.0, error_deg = 0.0;

  double fastest() const { return *std::max_element(one_thread.begin(), one_thread.end()); }
  std::string row(const std::string& scene) const {
    std::string row = fmt::format("| {} |", scene);
    for (const double rate : one_thread) row += fmt::format(" {} |", number_or_dash(rate));
    for (const double x : {all_threads, embree, embree > 0.0 ? fastest() / embree : 0.0,
                           embree > 0.0 ? one_thread[1] / embree : 0.0}) {
      row += fmt::format(" {} |", number_or_dash(x));
    }
    return row + fmt::format(" {:.1f} ms | {:.5f} deg |", rebuild_ms, error_deg);
  }
};

constexpr const char* kTableHead =
    "| scene | portable | AVX2 | AVX-512 | all threads | Embree | best / Embree | AVX2 / Embree | rebuild | "
    "exit direction |\n|---|---|---|---|---|---|---|---|---|---|\n";

Measured run(const BenchmarkScene& c, int cells, const std::shared_ptr<const RaySet>& rays) {
  const Scene scene = benchmark_scene(c, rays);
  std::unique_ptr<HeightField> field;
  const double build =
      wall_seconds([&] { field = std::make_unique<HeightField>(scene.reflectors[0].reflector, cells); });
  const double rebuild = best_of(5, wall_seconds, [&] { field->rebuild(); });
  const std::size_t beside = field->nodes().size() * sizeof(FieldNode);
  Measured m;
  m.rebuild_ms = 1e3 * rebuild;
  m.error_deg = exit_error_deg(scene, cells);
  fmt::print(
      "{:5} {:4}  build with evaluation {:7.1f} ms  hierarchy {:6.2f} ms, {:.2f} MB  exit error {:.5f} deg\n",
      c.name, cells, 1e3 * build, m.rebuild_ms, 1e-6 * static_cast<double>(beside), m.error_deg);
  const double n = static_cast<double>(rays->rays.size());
  const auto rate = [&](TraceOptions options, double (*clock)(const std::function<void()>&)) {
    options.cells = cells;
    options.max_bounces = kBenchmarkBounces;
    TraceResult result;
    const double per_s = rays_per_second(scene, options, rays->rays.size(), clock, &result);
    fmt::print("            {:10} {} thread(s) {:7.2f} M rays/s  {:.3f} reflections a ray\n", result.isa,
               ThreadLimit::current(), 1e-6 * per_s, ledger(result).reflections_per_ray.mean);
    return 1e-6 * per_s;
  };
  {
    const ThreadLimit one(1);
    for (std::size_t i = 0; i < kSets.size(); ++i) {
      try {
        kernels_named(kSets[i]);
        m.one_thread[i] = rate({.isa = kSets[i]}, cpu_seconds);
      } catch (const UsageError&) {
      }
    }
  }
  m.all_threads = rate({}, wall_seconds);
  fmt::print("            all threads / one: {:.2f}\n", m.all_threads / m.fastest());
  if (!EmbreeBaseline::available()) return m;
  const EmbreeBaseline embree(*field);
  std::vector<double> bins(std::size_t{360} * 181);
  const double t =
      best_of(2, cpu_seconds, [&] { embree.trace(rays->rays, c.focal_mm, kBenchmarkBounces, bins); });
  m.embree = 1e-6 * n / t;
  fmt::print("            embree     1 thread(s) {:7.2f} M rays/s  build {:.0f} ms; ours / Embree {:.1f}\n",
             m.embree, 1e3 * embree.build_s(), m.fastest() / m.embree);
  return m;
}

}  // namespace

int main(int argc, char** argv) {
  const auto rays = benchmark_rays(static_cast<std::size_t>((argc > 1 ? std::atof(argv[1]) : 4.0) * 1e6));
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {256, 1024, 2048};
  std::string table = kTableHead;
  for (const int cells : sizes) {
    for (const BenchmarkScene& c : benchmark_scenes())
      table += run(c, cells, rays).row(fmt::format("{} {}", cells, c.name)) + "\n";
  }
  fmt::print("{}", table);
}
