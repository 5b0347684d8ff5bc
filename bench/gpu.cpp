// SPDX-License-Identifier: Apache-2.0
// Tracing on CUDA devices: rays per second of the three scenes, from a model that is sampled on the device
// and from a ray file that is sent to it, and what the parts cost: drawing alone, drawing and counting,
// drawing and tracing; then what mirrors that are no height field, bodies, glasses and tents cost. Usage:
// bench_gpu [rays in millions = 1000] [cells ... = 1024 2048]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/optics/height_field/height_field.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/trace/device/device_scene.h"
#include "lucerna/trace/device/device_trace.h"
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

/// The mirror of `placed` as a smooth mesh of n x n squares over its rectangle or the circle's square.
Body mesh_of(const PlacedReflector& placed, std::uint32_t n) {
  auto mesh = std::make_shared<Mesh>();
  const Aperture& aperture = placed.reflector.aperture;
  for (std::uint32_t i = 0; i < (n + 1) * (n + 1); ++i) {
    const std::uint32_t column = i % (n + 1), row = i / (n + 1);
    const double x = (2.0 * column / n - 1.0) * aperture.half_x_mm();
    const double y = (2.0 * row / n - 1.0) * aperture.half_y_mm();
    mesh->vertices_mm.push_back({x, y, placed.reflector.surface->at(x, y).z_mm});
    if (column == n || row == n) continue;
    mesh->triangles.push_back({i, i + 1, i + n + 2});
    mesh->triangles.push_back({i, i + n + 2, i + n + 1});
  }
  Body body;
  body.mesh = mesh;
  body.world_from_body = placed.world_from_reflector;
  body.reflectance = placed.reflectance;
  body.smooth_below_deg = 30.0;
  return body;
}

/// Scenes that need more than the plain kernel, beside the plain one that they are made of.
std::vector<std::pair<std::string, Scene>> other_scenes(const Scene& plain) {
  const PlacedReflector& mirror = plain.reflectors[0];
  std::vector<std::pair<std::string, Scene>> all{{"plain", plain}};
  const auto add = [&](const char* name) -> Scene& { return all.emplace_back(name, plain).second; };
  add("swept curve, 256 points").reflectors[0].reflector = deep_ellipse_reflector(15.0, 120.0, 60.0);
  add("flat facets of 4 mm").reflectors[0].reflector.surface = std::make_shared<FacetedSurface>(
      mirror.reflector.surface, 4.0, std::numeric_limits<double>::infinity());
  add("with a cover glass").glasses = {
      {.aperture = Aperture::circle(1000.0),
       .world_from_glass = Frame::from_axis(Direction{}, 0.0, {0.0, 0.0, 300.0})}};
  for (const std::uint32_t n : {32U, 512U}) {
    Scene& scene = add(n == 32 ? "mesh of 2 k triangles" : "mesh of 0.5 M triangles");
    scene.reflectors.clear();
    scene.bodies = {mesh_of(mirror, n)};
  }
  add("tents").far_fields[0].tent = true;
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const auto rays = static_cast<std::uint64_t>((argc > 1 ? std::atof(argv[1]) : 1000.0) * 1e6);
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {1024, 2048};
  Accelerators devices = cuda_accelerators();
  if (devices.empty()) {
    fmt::print("{}\n", cuda_unavailable_reason());
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
  fmt::print("what a scene has more, from the model, M rays/s\n");
  Scene drawn = bench::scene_of(bench::kCases[0], file);
  drawn.sources[0].rays = model;
  for (const auto& [name, scene] : other_scenes(drawn)) {
    fmt::print("{:24} {:10.1f}\n", name, 1e-6 * rate(devices, scene, sizes[0], rays));
  }
}
