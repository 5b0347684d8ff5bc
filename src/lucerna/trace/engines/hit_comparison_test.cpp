// SPDX-License-Identifier: Apache-2.0
// Hit by hit over all families: the fast tracer against the scalar reference on the exact surface, and
// against Embree on the triangles of the same grid. Every disagreement is put down to its cause.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/random.h"
#include "lucerna/scene.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/kernels/exact_mirrors.h"
#include "lucerna/trace/kernels/field_view.h"
#include "tests/support/available_kernels.h"
#include "tests/support/random_direction.h"
#include "tests/support/test_mirrors.h"

namespace lucerna {
namespace {

using test::available_kernels;
using test::random_direction;

/// Mirrors that no grid represents: both tracers work on the exact shape.
std::vector<Reflector> exact_mirrors() {
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(90.0, 12.0));
  std::vector<ProfileKnot> arc;
  for (int i = 0; i <= 60; ++i) {
    const double a = radians(150.0) * i / 60;
    arc.push_back({40.0 * std::sin(a), 30.0 * (1.0 - std::cos(a))});
  }
  return {{std::make_shared<FacetedSurface>(base.surface, 6.0, 20.0), base.aperture},
          {std::make_shared<FacetedSurface>(base.surface, 6.0, HUGE_VAL), base.aperture},
          deep_ellipse_reflector(15.0, 60.0, 40.0, 6.0),
          profile_reflector({{4, 0}, {20, 0}, {34, 20}, {34, 40}, {28, 52}}, Aperture::circle(56.0, 12.0)),
          profile_trough(arc, Aperture::rectangle(40.0, 70.0))};
}

/// What a mirror's hits are evaluated by.
struct HitTolerance {
  /// How far the fast tracer's surface may be off: for grids the sagitta of a cell and the tolerance that its
  /// borders have (FieldView), else rounding to float.
  double off_mm = 0.0;
  /// Reach of the aperture in x, for a plain statement of how far a hit is from a rim.
  Aperture aperture = Aperture::circle(1.0);

  double from_rim_mm(const Vec3& p) const {
    const double r = std::hypot(p.x, p.y), hole = std::abs(r - aperture.hole_radius_mm());
    if (aperture.shape() == ApertureShape::circle) return std::min(hole, std::abs(r - aperture.half_x_mm()));
    return std::min({hole, std::abs(std::abs(p.x) - aperture.half_x_mm()),
                     std::abs(std::abs(p.y) - aperture.half_y_mm())});
  }
};

struct HitCounts {
  std::size_t rays = 0, hits = 0;
  /// Disagreements by cause: one of both hits the mirror within the tolerance of a rim; one grazes it
  /// (closer to the tangent plane than the tolerance can tell); none of these.
  std::size_t rim = 0, grazing = 0, unexplained = 0;
  /// Rays that start nearer to the mirror than the tolerance and differ: on which side they start is not
  /// said.
  std::size_t starts = 0;
  double squares_deg2 = 0.0;  ///< of the angle between normals

  std::size_t differ() const { return rim + grazing + unexplained; }
  HitCounts& operator+=(const HitCounts& o) {
    rays += o.rays;
    hits += o.hits;
    rim += o.rim;
    grazing += o.grazing;
    unexplained += o.unexplained;
    starts += o.starts;
    squares_deg2 += o.squares_deg2;
    return *this;
  }
};

std::ostream& operator<<(std::ostream& out, const HitCounts& c) {
  const double n = static_cast<double>(c.rays);
  return out << fmt::format(
             "{} rays, {} hits; differ {} ({:.1e} of the rays): rim {}, grazing {}, unexplained {}; {} start "
             "on the "
             "mirror; normals {:.1e} deg RMS",
             c.rays, c.hits, c.differ(), static_cast<double>(c.differ()) / n, c.rim, c.grazing, c.unexplained,
             c.starts, std::sqrt(c.squares_deg2 / std::max(1.0, static_cast<double>(c.hits))));
}

/// A hit of any tracer.
struct MirrorHit {
  int state = kMiss;
  double t = 0.0;
  Direction normal;
};

void classify(const HitTolerance& y, const Ray& ray, const MirrorHit& fast, const MirrorHit& other,
              HitCounts& c) {
  ++c.rays;
  c.hits += other.state != kMiss;
  if (fast.state == kMiss && other.state == kMiss) return;
  const auto cosine = [&](const MirrorHit& m) { return std::abs(dot(ray.direction, m.normal)); };
  if (fast.state == other.state) {
    const double apart = std::abs(fast.t - other.t);
    if (apart * std::max(cosine(fast), cosine(other)) <= y.off_mm) {
      c.squares_deg2 += std::pow(degrees(angle_between(fast.normal, other.normal)), 2);
      return;
    }
  }
  for (const MirrorHit* m : {&fast, &other}) {
    if (m->state != kMiss && m->t * cosine(*m) <= y.off_mm) {
      ++c.starts;
      return;
    }
  }
  for (const MirrorHit* m : {&fast, &other}) {
    if (m->state == kMiss) continue;
    // Off by so much in height, a hit moves by that over the cosine along the ray.
    if (y.from_rim_mm(ray.at(m->t)) <= y.off_mm / std::max(1e-3, cosine(*m)) + 1e-5) {
      ++c.rim;
      return;
    }
  }
  for (const MirrorHit* m : {&fast, &other}) {
    // A chord of a surface that bends with a radius of 4 mm or more dips by its angle squared times 2 mm.
    if (m->state != kMiss && std::pow(cosine(*m), 2) * 2.0 <= 2.0 * y.off_mm) {
      ++c.grazing;
      return;
    }
  }
  ++c.unexplained;
}

/// Calls `each(ray, fast hit)` for rays from everywhere about the mirror.
template <class Intersect, class Each>
void for_rays(std::uint64_t seed, std::size_t first, std::size_t last, const Intersect& intersect,
              const Each& each) {
  auto in = std::make_unique<LocalRays>();
  auto out = std::make_unique<LocalHits>();
  for (std::size_t at = first; at < last; at += kBatch) {
    const std::size_t n = std::min(kBatch, last - at);
    for (std::size_t i = 0; i < n; ++i) {
      Rng rng(seed, at + i);
      const Direction d = random_direction(rng);
      in->x[i] = static_cast<float>(100.0 * rng.uniform() - 50.0);
      in->y[i] = static_cast<float>(100.0 * rng.uniform() - 50.0);
      in->z[i] = static_cast<float>(80.0 * rng.uniform() - 20.0);
      in->dx[i] = static_cast<float>(d.x());
      in->dy[i] = static_cast<float>(d.y());
      in->dz[i] = static_cast<float>(d.z());
      in->on_mirror[i] = 0;
    }
    intersect(*in, n, *out);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 d{in->dx[i], in->dy[i], in->dz[i]};
      const Ray ray{{in->x[i], in->y[i], in->z[i]}, Direction::from(d)};
      MirrorHit fast;
      fast.state = out->state[i];
      if (fast.state != kMiss) {
        fast.t = static_cast<double>(out->t[i]) * length(d);
        fast.normal = Direction::from({-out->gx[i], -out->gy[i], out->gz[i]});
      }
      each(ray, fast);
    }
  }
}

/// The largest distance of a triangle over half a cell from the surface, at random places: of a function with
/// second derivatives hxx, hxy, hyy it is (|hxx| dx^2 + 2 |hxy| dx dy + |hyy| dy^2) / 8 at most, reached in
/// the middle of the diagonal.
double cell_sagitta_mm(const Reflector& mirror, int cells) {
  const Aperture& a = mirror.aperture;
  const double dx = 2.0 * a.half_x_mm() / cells, dy = 2.0 * a.half_y_mm() / cells;
  double max = 0.0;
  Rng rng(29, 0);
  for (int i = 0; i < 20000; ++i) {
    const double x = a.half_x_mm() * (2.0 * rng.uniform() - 1.0),
                 y = a.half_y_mm() * (2.0 * rng.uniform() - 1.0);
    if (!a.contains(x, y)) continue;
    const auto h = [&](double u, double v) { return mirror.surface->at(x + u * dx, y + v * dy).z_mm; };
    const double mixed = h(0.5, 0.5) - h(0.5, -0.5) - h(-0.5, 0.5) + h(-0.5, -0.5);
    const double sag = std::abs(h(0, 0) - 0.5 * (h(-0.5, 0) + h(0.5, 0))) +
                       std::abs(h(0, 0) - 0.5 * (h(0, -0.5) + h(0, 0.5))) + 0.25 * std::abs(mixed);
    const SurfacePoint s = mirror.surface->at(x, y);
    max = std::max(max, sag / std::sqrt(1.0 + s.dzdx * s.dzdx + s.dzdy * s.dzdy));
  }
  return max;
}

/// Rounding of heights to float32 at these sizes.
constexpr double kRounding = 4e-5;

template <class Intersect>
HitCounts against_reference(const Reflector& mirror, double off_mm, std::size_t rays,
                            const Intersect& intersect) {
  const ReferenceTracer reference(mirror, 7);
  const HitTolerance y{off_mm + kRounding, mirror.aperture};
  HitCounts sum;
  std::mutex mutex;
  parallel_blocks(rays, 64 * kBatch, [&](std::size_t first, std::size_t last) {
    HitCounts c;
    for_rays(11, first, last, intersect, [&](const Ray& ray, const MirrorHit& fast) {
      const auto hit = reference.first_hit(ray);
      classify(y, ray, fast,
               hit ? MirrorHit{hit->front ? kFront : kBack, hit->t_mm, hit->normal} : MirrorHit{}, c);
    });
    const std::lock_guard lock(mutex);
    sum += c;
  });
  return sum;
}

/// The grid's own vertices as triangles, over the whole rectangle.
std::shared_ptr<const Mesh> triangles_of(const HeightField& field) {
  auto mesh = std::make_shared<Mesh>();
  const auto n = static_cast<std::size_t>(field.cells()) + 1;
  for (std::size_t i = 0; i < n * n; ++i) {
    const double x =
        field.region().x0_mm + static_cast<double>(i % n) * static_cast<double>(field.step_x_mm());
    const double y =
        field.region().y0_mm + static_cast<double>(i / n) * static_cast<double>(field.step_y_mm());
    mesh->vertices_mm.push_back(
        {x, y, field.quadric().at(x, y).z_mm + static_cast<double>(field.vertices()[i].z_mm)});
  }
  for (std::size_t y = 0; y + 1 < n; ++y) {
    for (std::size_t x = 0; x + 1 < n; ++x) {
      const auto a = static_cast<std::uint32_t>(y * n + x), b = static_cast<std::uint32_t>(a + n);
      mesh->triangles.push_back({a, a + 1, b + 1});
      mesh->triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

/// First hit with the triangles inside the aperture: those outside are stepped through.
MirrorHit embree_hit(const BodyTracer& tracer, const Aperture& aperture, Ray ray) {
  double gone = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto hit = tracer.first_hit(ray, std::numeric_limits<float>::max(), false);
    if (!hit) return {};
    const Vec3 p = ray.at(hit->t_mm);
    if (aperture.contains(p.x, p.y)) {
      const bool front = hit->normal.z() > 0.0;
      return {front ? kFront : kBack, gone + hit->t_mm, front ? hit->normal : -hit->normal};
    }
    gone += hit->t_mm + 1e-3;
    ray.origin_mm = ray.at(hit->t_mm + 1e-3);
  }
  return {};
}

HitCounts against_embree(const Kernels& kernels, const Reflector& mirror, int cells, std::size_t rays) {
  const HeightField field(mirror, cells);
  const FieldView view = view_of(field);
  Body body;
  body.mesh = triangles_of(field);
  const BodyTracer tracer({body});
  const HitTolerance y{cell_sagitta_mm(mirror, cells) + static_cast<double>(view.tolerance) + kRounding,
                       mirror.aperture};
  HitCounts sum;
  std::mutex mutex;
  const auto intersect = [&](const LocalRays& in, std::size_t n, LocalHits& out) {
    kernels.intersect(view, in, n, out);
  };
  parallel_blocks(rays, 64 * kBatch, [&](std::size_t first, std::size_t last) {
    HitCounts c;
    for_rays(11, first, last, intersect, [&](const Ray& ray, const MirrorHit& fast) {
      classify(y, ray, fast, embree_hit(tracer, mirror.aperture, ray), c);
    });
    const std::lock_guard lock(mutex);
    sum += c;
  });
  return sum;
}

HitCounts field_against_reference(const Kernels& kernels, const Reflector& mirror, int cells,
                                  std::size_t rays) {
  const HeightField field(mirror, cells);
  const FieldView view = view_of(field);
  return against_reference(
      mirror, cell_sagitta_mm(mirror, cells) + static_cast<double>(view.tolerance), rays,
      [&](const LocalRays& in, std::size_t n, LocalHits& out) { kernels.intersect(view, in, n, out); });
}

HitCounts exact_against_reference(const Reflector& mirror, std::size_t rays) {
  if (mirror.curve) {
    const CurveView view = view_of(*mirror.curve, mirror.aperture);
    return against_reference(mirror, 0.0, rays, [&](const LocalRays& in, std::size_t n, LocalHits& out) {
      intersect_curve(view, in, n, out);
    });
  }
  const FacetMirror facets(*faceted(mirror), mirror.aperture);
  const FacetView view = facets.view();
  return against_reference(mirror, 0.0, rays, [&](const LocalRays& in, std::size_t n, LocalHits& out) {
    intersect_facets(view, in, n, out);
  });
}

// A hundred thousand rays for each instruction set.
TEST(HitComparison, EveryInstructionSetMeetsTheExactSurface) {
  for (const Kernels* kernels : available_kernels()) {
    HitCounts all;
    for (const Reflector& mirror : height_fields())
      all += field_against_reference(*kernels, mirror, 256, 10240);
    EXPECT_GT(all.hits, 20000u);
    EXPECT_LE(all.differ(), 4u) << kernels->isa << ": " << all;
    EXPECT_EQ(all.unexplained, 0u) << kernels->isa << ": " << all;
    EXPECT_LT(std::sqrt(all.squares_deg2 / static_cast<double>(all.hits)), 0.01) << kernels->isa;
  }
}

TEST(HitComparison, ExactMirrorsDifferByRoundingOnly) {
  HitCounts all;
  for (const Reflector& mirror : exact_mirrors()) all += exact_against_reference(mirror, 20480);
  EXPECT_GT(all.hits, 20000u);
  EXPECT_LE(all.differ(), 4u) << all;
  EXPECT_EQ(all.unexplained, 0u) << all;
}

TEST(HitComparison, EmbreeMeetsTheTrianglesOfTheSameGrid) {
  HitCounts all;
  for (const Reflector& mirror : height_fields()) all += against_embree(best_kernels(), mirror, 256, 10240);
  EXPECT_GT(all.hits, 20000u);
  EXPECT_LE(all.differ(), 6u) << all;
  EXPECT_EQ(all.unexplained, 0u) << all;
}

// 10^7 rays over all families at the grid that `trace` uses by default, by the best kernel; counts are
// printed.
TEST(HitComparisonSlow, TenMillionRaysOverAllFamilies) {
  const auto fields = height_fields(), exact = exact_mirrors();
  const std::size_t per_family = 10000000 / (fields.size() + exact.size()) + 1;
  HitCounts reference, embree;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const HitCounts c = field_against_reference(best_kernels(), fields[i], 1024, per_family);
    const HitCounts e = against_embree(best_kernels(), fields[i], 1024, per_family);
    std::cout << fmt::format("height field {}: reference: ", i) << c << "\n                Embree:    " << e
              << '\n';
    reference += c;
    embree += e;
  }
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const HitCounts c = exact_against_reference(exact[i], per_family);
    std::cout << fmt::format("exact shape {}:  reference: ", i) << c << '\n';
    reference += c;
  }
  std::cout << "all: reference: " << reference << "\n     Embree:    " << embree << '\n';
  EXPECT_GE(reference.rays, 10000000u);
  EXPECT_LT(static_cast<double>(reference.differ()), 1e-5 * static_cast<double>(reference.rays));
  EXPECT_LT(static_cast<double>(embree.differ()), 1e-5 * static_cast<double>(embree.rays));
  EXPECT_EQ(reference.unexplained + embree.unexplained, 0u);
}

}  // namespace
}  // namespace lucerna
