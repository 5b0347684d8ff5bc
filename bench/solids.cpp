// SPDX-License-Identifier: Apache-2.0
// Light through the first solid of a project (examples/tir-collimator.toml, bench/solids/free-form.toml):
// rays a second of one thread of processor time, by its own surface, by triangles, and by Embree 3 on the
// same triangles with the same physics; and first hits against Embree's, hit by hit. Usage:
// bench_solids PROJECT.toml [RAYS [CHECKED]] (1e6, 1e7)
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/project.h"
#include "lucerna/random.h"
#include "lucerna/trace/benchmark/benchmark.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/embree_device.h"
#include "lucerna/trace/engines/solid_tracer.h"

namespace {

using namespace lucerna;

/// What through_solid asks of a surface, by Embree's single rays.
class EmbreeSurface {
 public:
  explicit EmbreeSurface(const Body& body) : corner_normals_(smooth_normals(body)) {
    RTCGeometry g = embree_triangles(device_, body);
    rtcAttachGeometryByID(scene_.get(), g, 0);
    rtcReleaseGeometry(g);
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_.get());
  }

  SurfaceHit first(const Ray& ray, double t_min_mm, double) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit q{};
    const Vec3& o = ray.origin_mm;
    const Vec3& d = ray.direction.vec();
    q.ray.org_x = static_cast<float>(o.x), q.ray.org_y = static_cast<float>(o.y);
    q.ray.org_z = static_cast<float>(o.z), q.ray.dir_x = static_cast<float>(d.x);
    q.ray.dir_y = static_cast<float>(d.y), q.ray.dir_z = static_cast<float>(d.z);
    // In float a start on a triangle is found again up to some micrometres away.
    q.ray.tnear = static_cast<float>(t_min_mm > 0.0 ? kBodyStart : 0.0);
    q.ray.tfar = 1e30F;
    q.ray.mask = 0xFFFFFFFFU;
    q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &q);
    if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    normal_ = {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z};
    return {static_cast<std::int32_t>(q.hit.primID), static_cast<double>(q.ray.tfar),
            static_cast<double>(q.hit.u), static_cast<double>(q.hit.v)};
  }
  Vec3 outward(const Vec3&, const SurfaceHit&) const { return normal_; }
  Vec3 smooth(const Vec3&, const SurfaceHit& hit) const {
    if (corner_normals_.empty()) return {};
    return blended_normal(&corner_normals_[3 * static_cast<std::size_t>(hit.part)], hit.u, hit.v);
  }

 private:
  EmbreeDevice device_{"threads=1"};
  EmbreeScene scene_{device_};
  std::vector<Vec3> corner_normals_;
  /// Of the last hit: one thread, one ray at a time.
  mutable Vec3 normal_;
};

/// From a disk of 0.5 mm at the origin into the half space above it.
std::vector<Ray> rays_up(std::size_t n) {
  std::vector<Ray> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(11, i);
    const double r = 0.5 * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
    const double sine = std::sqrt(rng.uniform()), turn = 2.0 * std::numbers::pi * rng.uniform();
    out[i] = {{r * std::cos(phi), r * std::sin(phi), 0.0},
              Direction::from({sine * std::cos(turn), sine * std::sin(turn), std::sqrt(1.0 - sine * sine)})};
  }
  return out;
}

/// Share of the rays that leave upward within 2 degrees, and what is lost: the same light by any surface.
struct Outcome {
  double within = 0.0, lost = 0.0;
};

Outcome by_tracer(const SolidTracer& tracer, const std::vector<Ray>& rays) {
  constexpr std::size_t kBlock = 512;
  Outcome out;
  std::vector<double> t_max_mm;
  std::vector<std::optional<GlassHit>> hits;
  std::vector<GlassRay> met;
  std::vector<GlassPassage> passages;
  for (std::size_t first = 0; first < rays.size(); first += kBlock) {
    const std::size_t n = std::min(kBlock, rays.size() - first);
    const auto block = std::span(rays).subspan(first, n);
    t_max_mm.assign(n, 1e300);
    hits.assign(n, std::nullopt);
    tracer.first_hits(block, false, t_max_mm, hits);
    met.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (hits[i]) met.push_back({block[i], *hits[i], {1, first + i, 0}, 0.0F});
    }
    passages.assign(met.size(), {});
    tracer.pass(met, 0, passages);
    for (const GlassPassage& p : passages) {
      out.within += p.ray.direction.z() > std::cos(radians(2.0)) ? 1.0 : 0.0;
      out.lost += p.lost ? 1.0 : 0.0;
    }
  }
  return out;
}

Outcome by_embree(const EmbreeSurface& surface, const MediumView& medium, const std::vector<Ray>& rays) {
  Outcome out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SurfaceHit hit = surface.first(rays[i], 0.0, 1e300);
    if (hit.part < 0) continue;
    const GlassPassage p = through_solid(surface, medium, {}, rays[i], hit, {1, i, 0}, [](const Vec3&) {});
    out.within += p.ray.direction.z() > std::cos(radians(2.0)) ? 1.0 : 0.0;
    out.lost += p.lost ? 1.0 : 0.0;
  }
  return out;
}

/// Medians of three, interleaved.
void print_speeds(const Solid& outline, const Solid& triangles, const EmbreeSurface& embree, std::size_t n) {
  const std::vector<Ray> rays = rays_up(n);
  const SolidTracer cones({outline}), mesh({triangles});
  const MediumView medium{outline.refractive_index, outline.absorption_per_mm};
  std::vector<double> seconds[3];
  Outcome found[3];
  for (int turn = 0; turn < 3; ++turn) {
    seconds[0].push_back(cpu_seconds([&] { found[0] = by_tracer(cones, rays); }));
    seconds[1].push_back(cpu_seconds([&] { found[1] = by_tracer(mesh, rays); }));
    seconds[2].push_back(cpu_seconds([&] { found[2] = by_embree(embree, medium, rays); }));
  }
  fmt::print("| surface | rays/s | over Embree | within 2 degrees | lost |\n|---|---|---|---|---|\n");
  const char* const names[3] = {"the body itself", "triangles", "Embree 3, the same triangles"};
  for (int i = 0; i < 3; ++i) std::sort(seconds[i].begin(), seconds[i].end());
  for (int i = 0; i < 3; ++i) {
    const double all = static_cast<double>(n);
    fmt::print("| {} | {:.3g} | {:.2f} | {:.4f} | {:.1e} |\n", names[i], all / seconds[i][1],
               seconds[2][1] / seconds[i][1], found[i].within / all, found[i].lost / all);
  }
}

/// First hits of the same rays from outside, of the body and of Embree's triangles: how many are seen by one
/// only, and how far they differ.
void print_hits(const Solid& body, const EmbreeSurface& embree, std::size_t n) {
  const SolidTracer own({body});
  const std::vector<Ray> rays = rays_up(n);
  std::size_t one_only = 0, hits = 0;
  double worst_mm = 0.0;
  for (const Ray& ray : rays) {
    const auto ours = own.first_hit(ray, 1e300, false);
    const SurfaceHit theirs = embree.first(ray, 0.0, 1e300);
    hits += ours ? 1 : 0;
    if (ours.has_value() != (theirs.part >= 0)) {
      ++one_only;
    } else if (ours) {
      worst_mm = std::max(worst_mm, std::abs(ours->t_mm - theirs.t_mm));
    }
  }
  fmt::print("{} rays: {} hits, {} seen by one only, distances within {:.2g} mm\n", n, hits, one_only,
             worst_mm);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_solids PROJECT.toml [RAYS [CHECKED]]\n");
    return 2;
  }
  const auto number = [&](int at, double standard) {
    return static_cast<std::size_t>(argc > at ? std::atof(argv[at]) : standard);
  };
  const Solid outline = read_project(argv[1]).scene.solids.at(0);
  Solid triangles = outline;
  triangles.mesh = surface_mesh(outline);
  triangles.outline_mm.clear();
  triangles.face = triangles.bottom_face = nullptr;
  Body body;
  body.mesh = triangles.mesh;
  body.smooth_below_deg = triangles.smooth_below_deg;
  const EmbreeSurface embree(body);
  print_speeds(outline, triangles, embree, number(2, 1e6));
  print_hits(outline, embree, number(3, 1e7));
}
