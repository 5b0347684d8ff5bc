// SPDX-License-Identifier: Apache-2.0
// Tracing on CUDA devices: rays per second of the three scenes, from a model that is sampled on the device
// and from a ray file that is sent to it, and what the parts cost: drawing alone, drawing and counting,
// drawing and tracing. Usage: bench_gpu [rays in millions = 1000] [cells ... = 1024 2048]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <functional>

#include "lucerna/reflector/height_field.h"
#include "lucerna/source/adaptive_compress.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/trace/device_scene.h"
#include "lucerna/trace/device_trace.h"
#include "trace_scenes.h"

namespace {

using namespace lucerna;

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Rays per second without the time to set up, best of three.
double rate(const Accelerators& devices, const Scene& scene, int cells, std::uint64_t rays) {
  double best = 1e30;
  for (int i = 0; i < 3; ++i) {
    const auto run = [&](std::uint64_t n) {
      return seconds([&] { trace_on(devices, scene, {.last_ray = n, .max_bounces = 4, .cells = cells}); });
    };
    best = std::min(best, run(rays) - run(1));
  }
  return static_cast<double>(rays) / best;
}

Scene without(Scene scene, bool mirrors, bool detectors) {
  if (mirrors) scene.reflectors.clear();
  if (detectors) scene.far_fields.clear();
  return scene;
}

void run(const Accelerators& devices, const bench::Case& c, int cells, std::uint64_t rays,
         const std::shared_ptr<const RaySet>& file, const std::shared_ptr<const AdaptiveModel>& model) {
  const Scene sent = bench::scene_of(c, file);
  Scene drawn = sent;
  drawn.sources[0].rays = model;
  const double from_file = rate(devices, sent, cells, std::min<std::uint64_t>(rays, file->rays.size()));
  fmt::print("{:5} {:4}  {:10.1f} {:10.1f} {:10.1f} {:10.1f} {:10.1f}\n", c.name, cells,
             1e-6 * rate(devices, drawn, cells, rays), 1e-6 * from_file,
             1e-6 * rate(devices, without(drawn, true, true), cells, rays),
             1e-6 * rate(devices, without(drawn, true, false), cells, rays),
             1e-6 * rate(devices, without(drawn, false, true), cells, rays));
}

/// A change of shape: upload of the vertices, and the tree made from them.
void rebuild(Accelerator& device, const Scene& scene, int cells) {
  const HeightField field(scene.reflectors[0].reflector, cells);
  DeviceScene on_device(device, scene, RayNumbering(scene.sources, 1), {.cells = cells});
  double best = 1e30;
  for (int i = 0; i < 5; ++i)
    best = std::min(best, seconds([&] { on_device.set_vertices(0, field.vertices()); }));
  fmt::print("{:4} cells a side: new shape sent and its tree made in {:.3f} ms\n", cells, 1e3 * best);
}

}  // namespace

int main(int argc, char** argv) {
  const auto rays = static_cast<std::uint64_t>((argc > 1 ? std::atof(argv[1]) : 1000.0) * 1e6);
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {1024, 2048};
  Accelerators devices = cuda_accelerators();
  if (devices.empty()) {
    fmt::print("{}\n", why_no_cuda());
    return 0;
  }
  devices.resize(1);
  fmt::print("{}, {} M rays; M rays/s\n", devices[0]->name(), 1e-6 * static_cast<double>(rays));
  const auto file = bench::cylinder(20000000);
  auto some = std::make_shared<RaySet>();
  some->header.set_flux(1000.0);
  some->rays = draw_rays(RaySetSource(file, "cylinder"), Sequence(SequenceKind::random, 1), 1000000);
  const std::shared_ptr<const AdaptiveModel> model = compress_adaptive(*some, {});
  fmt::print("scene cells      model       file  draw only draw+count draw+trace\n");
  for (const int cells : sizes) {
    for (const bench::Case& c : bench::kCases) run(devices, c, cells, rays, file, model);
  }
  for (const int cells : sizes) rebuild(*devices[0], bench::scene_of(bench::kCases[0], file), cells);
}
