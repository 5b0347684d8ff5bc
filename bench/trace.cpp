// SPDX-License-Identifier: Apache-2.0
// Rays per second through a mirror of 100 x 100 mm, the scenes of design.md section 6: para (f 15), wavy
// (with pillows of 0.4 mm and 8 mm pitch), deep (f 5 with pillows). Cylinder source r 1, length 6, isotropic
// from its mantle; reflectance 0.9, at most 4 reflections; Type C bins of one degree. Rays are in memory, in
// random order. Beside it Embree on the same grid as triangles, in streams of 16 rays with the same binning.
// Usage: bench_trace [rays in millions = 4] [cells ... = 256 1024 2048]
#include "lucerna/trace/trace.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "lucerna/core/parallel.h"
#include "lucerna/reflector/height_field.h"
#include "lucerna/trace/kernel.h"
#include "lucerna/trace/reference_tracer.h"
#include "trace_scenes.h"
#if defined(LUCERNA_EMBREE)
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace {

using namespace lucerna;
using bench::Case, bench::cylinder, bench::scene_of;

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds of processor time: on a machine that others use too, what one thread's work costs.
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

#if defined(LUCERNA_EMBREE)
/// Embree on the triangles of a height field. Its shell is vectorised as far as its interface lets it: rays
/// go in packets of 16 in structure-of-arrays form, and reflection and binning use the same kernels as ours.
class EmbreeTracer {
 public:
  explicit EmbreeTracer(const HeightField& field) : field_(field) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    device_ = rtcNewDevice("threads=1");
    scene_ = rtcNewScene(device_);
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto n = static_cast<std::size_t>(field.cells()) + 1;
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n * n));
    auto* t = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * (n - 1) * (n - 1)));
    for (std::size_t i = 0; i < n * n; ++i) {
      const double x =
          field.region().x0_mm + static_cast<double>(i % n) * static_cast<double>(field.step_x_mm());
      const double y =
          field.region().y0_mm + static_cast<double>(i / n) * static_cast<double>(field.step_y_mm());
      v[3 * i] = static_cast<float>(x);
      v[3 * i + 1] = static_cast<float>(y);
      v[3 * i + 2] =
          static_cast<float>(field.quadric().at(x, y).z_mm + static_cast<double>(field.vertices()[i].z_mm));
    }
    for (std::size_t y = 0; y + 1 < n; ++y) {
      for (std::size_t x = 0; x + 1 < n; ++x) {
        const auto a = static_cast<unsigned>(y * n + x), b = static_cast<unsigned>(a + n);
        for (const unsigned k : {a, a + 1, b + 1, a, b + 1, b}) *t++ = k;
      }
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    build_s = seconds([&] { rtcCommitScene(scene_); });
  }
  ~EmbreeTracer() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  double build_s = 0.0;

  /// All rays, at most `bounces` reflections; bins at one degree.
  void trace(const RayBlock& source, double lift_mm, int bounces, std::vector<double>& bins) const {
    const Kernels& kernels = best_kernels();
    const FrameView same{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    auto rays = std::make_unique<WorldRays>();
    auto local = std::make_unique<LocalRays>();
    auto hits = std::make_unique<LocalHits>();
    for (std::size_t first = 0; first < source.size(); first += kBatch) {
      std::size_t n = std::min(kBatch, source.size() - first);
      for (std::size_t i = 0; i < n; ++i) {
        rays->x[i] = source.x_mm[first + i];
        rays->y[i] = source.y_mm[first + i];
        rays->z[i] = source.z_mm[first + i] + static_cast<float>(lift_mm);
        rays->dx[i] = source.kx[first + i];
        rays->dy[i] = source.ky[first + i];
        rays->dz[i] = source.kz[first + i];
        rays->flux[i] = 1.0F;
        rays->mirror[i] = -1;
      }
      for (int bounce = 0; n > 0; ++bounce)
        n = step(kernels, same, *rays, *local, *hits, n, bounce < bounces, bins);
    }
  }

 private:
  std::size_t step(const Kernels& kernels, const FrameView& same, WorldRays& rays, LocalRays& local,
                   LocalHits& hits, std::size_t n, bool reflect, std::vector<double>& bins) const {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[16];
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    kernels.to_local(same, rays, n, 0, local);
    for (std::size_t i = 0; i < n; i += 16) {
      for (std::size_t k = 0; k < 16; ++k) {
        valid[k] = i + k < n ? -1 : 0;
        packet.ray.org_x[k] = rays.x[i + k];
        packet.ray.org_y[k] = rays.y[i + k];
        packet.ray.org_z[k] = rays.z[i + k];
        packet.ray.dir_x[k] = rays.dx[i + k];
        packet.ray.dir_y[k] = rays.dy[i + k];
        packet.ray.dir_z[k] = rays.dz[i + k];
        packet.ray.tnear[k] = rays.mirror[i + k] == 0 ? 1e-3F : 0.0F;
        packet.ray.tfar[k] = 1e18F;
        packet.ray.time[k] = 0.0F;
        packet.ray.mask[k] = 0xFFFFFFFFU;
        packet.ray.flags[k] = 0;
        packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, scene_, &context, &packet);
      for (std::size_t k = 0; k < 16; ++k) {
        const bool met = valid[k] != 0 && packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
        hits.t[i + k] = packet.ray.tfar[k];
        const float per = met ? -1.0F / packet.hit.Ng_z[k] : 0.0F;
        hits.gx[i + k] = packet.hit.Ng_x[k] * per;
        hits.gy[i + k] = packet.hit.Ng_y[k] * per;
        const float towards = -packet.hit.Ng_x[k] * per * rays.dx[i + k] -
                              packet.hit.Ng_y[k] * per * rays.dy[i + k] + rays.dz[i + k];
        hits.state[i + k] = !met ? kMiss : towards < 0.0F ? kFront : kBack;
      }
    }
    alignas(64) float cosine[kBatch];
    alignas(64) std::int32_t cell[kBatch];
    kernels.far_field_cells(rays, n, 360, 181, cell);
    if (reflect) kernels.reflect(same, local, hits, n, rays, cosine);
    std::size_t stay = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (hits.state[i] == kMiss)
        bins[static_cast<std::size_t>(cell[i])] += static_cast<double>(rays.flux[i]);
      if (hits.state[i] != kFront || !reflect) continue;
      rays.x[stay] = rays.x[i];
      rays.y[stay] = rays.y[i];
      rays.z[stay] = rays.z[i];
      rays.dx[stay] = rays.dx[i];
      rays.dy[stay] = rays.dy[i];
      rays.dz[stay] = rays.dz[i];
      rays.flux[stay] = 0.9F * rays.flux[i];
      rays.mirror[stay++] = 0;
    }
    return stay;
  }

  const HeightField& field_;
  RTCDevice device_;
  RTCScene scene_;
};
#endif

void run(const Case& c, int cells, const std::shared_ptr<RaySet>& rays) {
  const Scene scene = scene_of(c, rays);
  std::unique_ptr<HeightField> field;
  const double build =
      seconds([&] { field = std::make_unique<HeightField>(scene.reflectors[0].reflector, cells); });
  const double rebuild = best_of(5, seconds, [&] { field->rebuild(); });
  const std::size_t beside = field->nodes().size() * sizeof(FieldNode);
  fmt::print(
      "{:5} {:4}  build with evaluation {:7.1f} ms  hierarchy {:6.2f} ms, {:.2f} MB  exit error {:.5f} deg\n",
      c.name, cells, 1e3 * build, 1e3 * rebuild, 1e-6 * static_cast<double>(beside),
      exit_error_deg(scene, cells));
  const double n = static_cast<double>(rays->rays.size());
  const auto rate = [&](TraceOptions options, double (*clock)(const std::function<void()>&)) {
    options.cells = cells;
    options.max_bounces = 4;
    options.last_ray = rays->rays.size();
    TraceOptions none = options;
    none.last_ray = 1;
    const double setup = best_of(2, clock, [&] { trace(scene, none); });
    TraceResult result;
    const double t = best_of(2, clock, [&] { result = trace(scene, options); }) - setup;
    fmt::print("            {:10} {} thread(s) {:7.2f} M rays/s  {:.3f} reflections a ray\n", result.isa,
               ThreadLimit::current(), 1e-6 * n / t, ledger(result).reflections_per_ray);
    return n / t;
  };
  double fast = 0.0;
  {
    const ThreadLimit one(1);
    for (const char* isa : {"portable", "avx2", "avx512"}) {
      try {
        kernels_named(isa);
        fast = rate({.isa = isa}, cpu_seconds);
      } catch (const UsageError&) {
      }
    }
  }
  const double two = rate({}, seconds);
  fmt::print("            all threads / one: {:.2f}\n", two / fast);
#if defined(LUCERNA_EMBREE)
  const EmbreeTracer embree(*field);
  std::vector<double> bins(360 * 181);
  const double t = best_of(2, cpu_seconds, [&] { embree.trace(rays->rays, c.focal_mm, 4, bins); });
  fmt::print("            embree     1 thread(s) {:7.2f} M rays/s  build {:.0f} ms; ours / Embree {:.1f}\n",
             1e-6 * n / t, 1e3 * embree.build_s, fast * t / n);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  const auto rays = cylinder(static_cast<std::size_t>((argc > 1 ? std::atof(argv[1]) : 4.0) * 1e6));
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {256, 1024, 2048};
  for (const int cells : sizes) {
    for (const Case& c : bench::kCases) run(c, cells, rays);
  }
}
