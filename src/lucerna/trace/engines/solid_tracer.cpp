// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/mesh/faced_solid.h"
#include "lucerna/optics/shapes/faced_outline.h"
#include "lucerna/trace/engines/body_tracer.h"

namespace lucerna {

namespace {

/// Edges that two triangles run along in the same direction: one of them is turned.
std::size_t turned_edges(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::size_t turned = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) turned += seen.insert({t[k], t[(k + 1) % 3]}).second ? 0 : 1;
  }
  return turned;
}

void check_mesh(const Solid& solid) {
  if (solid.mesh->triangles.empty()) throw InputError(fmt::format("solid '{}' has no triangles", solid.name));
  if (const std::size_t open = open_edges(*solid.mesh); open > 0) {
    throw InputError(
        fmt::format("solid '{}' is open: {} edges do not belong to exactly two triangles; "
                    "expected a closed surface",
                    solid.name, open));
  }
  if (const std::size_t turned = turned_edges(*solid.mesh); turned > 0) {
    throw InputError(
        fmt::format("solid '{}': at {} edges one of two triangles is turned; expected all of "
                    "them counter-clockwise seen from outside, or all clockwise",
                    solid.name, turned));
  }
}

/// Straight pieces leave the curve of an outline by at most this share of its size.
constexpr double kCurveTolerance = 1e-7;

std::vector<OutlineSide> sides_of(const Solid& solid, double tolerance) {
  return outline_sides(solid.outline_mm, solid.smooth_below_deg,
                       tolerance * outline_reach_mm(solid.outline_mm));
}

/// Of a solid that has a face.
BodyFaces faces_of(const Solid& solid) { return {*solid.face, solid.bottom_face.get()}; }

/// Errors of its shape, with the name of the solid.
void check_faces(const Solid& solid) {
  try {
    check_faced_outline(solid.outline_mm, faces_of(solid), solid.smooth_below_deg);
  } catch (const InputError& e) {
    throw InputError(fmt::format("solid '{}': {}", solid.name, e.what()), e.cause());
  }
}

std::unique_ptr<const FacedBody> faced_body(const Solid& solid) {
  const double tolerance_mm = kCurveTolerance * faced_reach_mm(solid.outline_mm, faces_of(solid));
  return std::make_unique<const FacedBody>(solid.outline_mm, solid.face, solid.bottom_face,
                                           solid.smooth_below_deg, tolerance_mm);
}

/// By corners of the outline of a body, with the faces' lid and floor where it has them: does what begins
/// there scatter?
std::vector<bool> rough_corners(const Solid& solid) {
  if (solid.face == nullptr)
    return sides_of_faces(solid.outline_mm, solid.smooth_below_deg, solid.scatter_sides);
  std::vector<std::size_t> sides = solid.scatter_sides;
  if (solid.bottom_face) {
    // Between lid and floor the closed outline has a side along the axis, which nobody counts.
    for (std::size_t& side : sides) side += side >= solid.outline_mm.size() ? 1 : 0;
  }
  return sides_of_faces(faced_base(solid.outline_mm, solid.smooth_below_deg).corners, solid.smooth_below_deg,
                        sides);
}

/// The same by parts of its surface, which begin at these corners.
std::vector<std::uint8_t> rough_parts(const Solid& solid, const std::vector<std::size_t>& corners) {
  if (solid.scatter_sides.empty()) return {};
  const std::vector<bool> rough = rough_corners(solid);
  std::vector<std::uint8_t> out;
  for (const std::size_t corner : corners) out.push_back(rough[corner] ? 1 : 0);
  return out;
}

std::vector<std::size_t> corners_of(const std::vector<OutlineSide>& sides) {
  std::vector<std::size_t> out;
  for (const OutlineSide& s : sides) out.push_back(s.corner);
  return out;
}

void check_scatter(const Solid& solid) {
  if (solid.scatter.measured() != nullptr) {
    throw InputError(
        fmt::format("solid '{}': a measured BRDF belongs to mirrors, expected lobes", solid.name),
        ErrorCause::unsupported);
  }
  if (solid.scatter_sides.empty()) return;
  const auto fail = [&](const std::string& why) {
    throw InputError(fmt::format("solid '{}': scatter_sides: {}", solid.name, why));
  };
  if (solid.scatter.empty()) fail("no lobes that they could have");
  if (solid.mesh != nullptr) fail("a mesh has no sides, expected an outline");
  try {
    static_cast<void>(rough_corners(solid));
  } catch (const InputError& e) {
    fail(e.what());
  }
}

}  // namespace

void check(const Solid& solid) {
  const auto need = [&](bool good, const char* what, double value, const char* expected) {
    if (!good)
      throw InputError(fmt::format("solid '{}': {} is {}, expected {}", solid.name, what, value, expected));
  };
  if ((solid.mesh == nullptr) == solid.outline_mm.empty()) {
    throw InputError(fmt::format("solid '{}' has {}, expected either a mesh or an outline", solid.name,
                                 solid.mesh == nullptr ? "no surface" : "both"));
  }
  if (solid.face != nullptr && solid.mesh != nullptr)
    throw InputError(
        fmt::format("solid '{}' has a mesh and a face, expected a face with an outline", solid.name));
  if (solid.bottom_face != nullptr && solid.face == nullptr)
    throw InputError(
        fmt::format("solid '{}' has a bottom face alone, expected one at the top too", solid.name));
  need(solid.refractive_index >= 1.0 && solid.refractive_index <= 4.0, "refractive_index",
       solid.refractive_index, "1 to 4");
  need(solid.absorption_per_mm >= 0.0 && std::isfinite(solid.absorption_per_mm), "absorption_per_mm",
       solid.absorption_per_mm, "a finite number >= 0");
  need(solid.smooth_below_deg >= 0.0 && solid.smooth_below_deg <= 180.0, "smooth_below_deg",
       solid.smooth_below_deg, "0 to 180");
  if (solid.mesh != nullptr) {
    check_mesh(solid);
  } else if (solid.face != nullptr) {
    check_faces(solid);
  } else {
    (void)sides_of(solid, kSurfaceTolerance);
  }
  check_scatter(solid);
}

std::shared_ptr<const Mesh> surface_mesh(const Solid& solid, double tolerance) {
  if (!(tolerance >= 1e-8 && tolerance <= 1.0))
    throw InputError(fmt::format("tolerance of a mesh: found {}, expected 1e-8 to 1", tolerance));
  if (solid.mesh != nullptr) return solid.mesh;
  if (solid.face != nullptr) {
    check_faces(solid);
    return std::make_shared<const Mesh>(
        faced_solid(solid.outline_mm, faces_of(solid), solid.smooth_below_deg, tolerance));
  }
  std::vector<OutlinePoint> corners;
  for (const OutlineSide& side : sides_of(solid, tolerance)) {
    if (corners.empty() || corners.back() != side.from) corners.push_back(side.from);
    corners.push_back(side.to);
  }
  if (corners.back() == corners.front()) corners.pop_back();
  return std::make_shared<const Mesh>(solid_of_revolution(corners));
}

SolidTracer::SolidTracer(const std::vector<Solid>& solids) {
  for (const Solid& s : solids) {
    check(s);
    Traced traced;
    traced.medium = {s.refractive_index, s.absorption_per_mm};
    traced.dispersion = s.dispersion;
    traced.scatter = s.scatter;
    traced.world_from_solid = s.world_from_solid;
    traced.solid_from_world = s.world_from_solid.inverse();
    if (s.mesh != nullptr) {
      traced.mesh = std::make_unique<const SolidMesh>(s.mesh, s.smooth_below_deg);
    } else if (s.face != nullptr) {
      traced.faced = faced_body(s);
      traced.rough = rough_parts(s, traced.faced->corners());
    } else {
      const std::vector<OutlineSide> sides = sides_of(s, kCurveTolerance);
      traced.revolved = std::make_unique<const RevolvedTree>(sides);
      traced.rough = rough_parts(s, corners_of(sides));
    }
    solids_.push_back(std::move(traced));
  }
}

MediumView SolidTracer::Traced::medium_at(float wavelength_nm) const {
  if (dispersion == nullptr || !(wavelength_nm > 0.0F)) return medium;
  const double nm = wavelength_nm;
  return {dispersion->index(nm),
          dispersion->has_absorption() ? dispersion->absorption_per_mm(nm) : medium.absorption_per_mm};
}

SolidFinish SolidTracer::Traced::finish() const {
  const auto& lobes = scatter.lobes();
  return {{.lobes = lobes.data(), .lobe_count = static_cast<std::uint32_t>(lobes.size())},
          rough.empty() ? nullptr : rough.data()};
}

namespace {

/// Of a ray on its way between bodies, which meets no surface from inside. Its place is rounded to float:
/// after it left a body it may stand a little within.
template <class Surface>
SurfaceHit first_from_outside(const Surface& surface, const Ray& ray, double t_max_mm) {
  SurfaceHit hit;
  do {
    hit = surface.first(ray, hit.t_mm + kSolidStart, t_max_mm);
  } while (hit.part >= 0 && dot(surface.outward(ray.at(hit.t_mm), hit), ray.direction.vec()) > 0.0);
  return hit;
}

}  // namespace

std::optional<GlassHit> SolidTracer::first_hit(const Ray& ray, double t_max_mm, bool started) const {
  std::optional<GlassHit> out;
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const SurfaceHit hit = solids_[i].with_surface([&](const auto& surface) {
      const Ray local = solids_[i].solid_from_world.ray(ray);
      return started ? first_from_outside(surface, local, t_max_mm) : surface.first(local, 0.0, t_max_mm);
    });
    if (hit.part < 0) continue;
    out = GlassHit{hit.t_mm, i, false, hit.part, hit.u, hit.v};
    t_max_mm = hit.t_mm;
  }
  return out;
}

void SolidTracer::first_hits(std::span<const Ray> rays, bool started, std::span<double> t_max_mm,
                             std::span<std::optional<GlassHit>> hits) const {
  for (std::size_t solid = 0; solid < solids_.size(); ++solid) {
    for (std::size_t i = 0; i < rays.size(); i += kSolidBatch) {
      const std::size_t n = std::min(kSolidBatch, rays.size() - i);
      find_surfaces(solid, rays.subspan(i, n), started, t_max_mm.subspan(i, n), hits.subspan(i, n));
    }
  }
}

void SolidTracer::find_surfaces(std::size_t solid, std::span<const Ray> rays, bool started,
                                std::span<double> t_max_mm, std::span<std::optional<GlassHit>> hits) const {
  const Traced& traced = solids_[solid];
  SolidBatch batch;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    put_ray(traced.solid_from_world.ray(rays[i]), i, batch);
    batch.t[i] = t_max_mm[i];
    batch.v[i] = 0.0;
  }
  traced.with_batch_surface([&](const auto& surface) {
    surface.first(started ? kSolidStart : 0.0, rays.size(), batch);
    if (started) surface.normals(rays.size(), batch);
  });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    SurfaceHit hit{batch.part[i], batch.t[i], batch.u[i], batch.v[i]};
    if (hit.part < 0) continue;
    const Ray local = ray_of(batch, i);
    if (started && dot(outward_of(batch, i), local.direction.vec()) > 0.0) {
      hit = traced.with_surface(
          [&](const auto& surface) { return first_from_outside(surface, local, t_max_mm[i]); });
      if (hit.part < 0) continue;
    }
    hits[i] = GlassHit{hit.t_mm, solid, false, hit.part, hit.u, hit.v};
    t_max_mm[i] = hit.t_mm;
  }
}

GlassPassage SolidTracer::pass(const Ray& ray, const GlassHit& hit, const ReflectionKey& key,
                               float wavelength_nm, const std::function<void(const Vec3&)>& visit) const {
  const Traced& solid = solids_[hit.glass];
  const MediumView medium = solid.medium_at(wavelength_nm);
  const SurfaceHit at{hit.part, hit.t_mm, hit.u, hit.v};
  GlassPassage out = solid.with_surface([&](const auto& surface) {
    return through_solid(surface, medium, solid.finish(), solid.solid_from_world.ray(ray), at, key,
                         [&](const Vec3& point) {
                           if (visit) visit(solid.world_from_solid.point(point));
                         });
  });
  out.ray = solid.world_from_solid.ray(out.ray);
  return out;
}

void SolidTracer::pass(std::span<const GlassRay> rays, std::size_t first_solid,
                       std::span<GlassPassage> out) const {
  std::vector<std::size_t> which;
  for (std::size_t solid = 0; solid < solids_.size(); ++solid) {
    const auto flush = [&] {
      pass_solid(solid, rays, which, out);
      which.clear();
    };
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rays[i].hit.glass != first_solid + solid) continue;
      which.push_back(i);
      if (which.size() == kSolidBatch) flush();
    }
    if (!which.empty()) flush();
  }
}

void SolidTracer::pass_solid(std::size_t number, std::span<const GlassRay> rays,
                             std::span<const std::size_t> which, std::span<GlassPassage> out) const {
  const Traced& solid = solids_[number];
  std::vector<MediumView> media;
  media.reserve(which.size());
  for (const std::size_t i : which) media.push_back(solid.medium_at(rays[i].wavelength_nm));
  SolidFlight flight(best_solid_kernels(), {solid.world_from_solid, solid.solid_from_world, solid.finish()},
                     rays, which, media, out);
  solid.with_batch_surface([&](const auto& surface) { flight.run(surface); });
}

}  // namespace lucerna
