// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/engines/faced_body.h"
#include "lucerna/trace/engines/solid_mesh.h"
#include "lucerna/trace/engines/solid_rays.h"
#include "lucerna/trace/kernels/revolved_tree.h"
#include "lucerna/trace/kernels/solid_kernel.h"
#include "lucerna/trace/kernels/solid_kernels.h"

namespace lucerna {

/// A ray that met something clear, in the luminaire frame, and what decides what becomes of it there.
struct GlassRay {
  Ray ray;
  GlassHit hit;
  ReflectionKey key;
  float wavelength_nm = 0.0F;
};

// A surface as SolidFlight takes it: the `first` hits in (t_min_mm, batch.t) of n rays, and the `normals`
// there, of rays that hit it.

/// An outline that turns about z.
class RevolvedBatchSurface {
 public:
  RevolvedBatchSurface(const RevolvedTree& tree, const SolidKernels& kernels)
      : blocks_(tree.blocks()), kernels_(&kernels) {}

  void first(double t_min_mm, std::size_t n, SolidBatch& batch) const {
    kernels_->first_sides(blocks_, t_min_mm, n, batch);
  }
  void normals(std::size_t n, SolidBatch& batch) const { kernels_->side_normals(blocks_.sides, n, batch); }

 private:
  RevolvedBlocks blocks_;
  const SolidKernels* kernels_;
};

/// A body with faces.
class FacedBatchSurface {
 public:
  FacedBatchSurface(const FacedBody& body, const SolidKernels& kernels) : body_(&body), kernels_(&kernels) {}

  void first(double t_min_mm, std::size_t n, SolidBatch& batch) const {
    body_->first(*kernels_, t_min_mm, n, batch);
  }
  void normals(std::size_t n, SolidBatch& batch) const { body_->normals(*kernels_, n, batch); }

 private:
  const FacedBody* body_;
  const SolidKernels* kernels_;
};

/// A body of triangles, one ray at a time.
class MeshBatchSurface {
 public:
  explicit MeshBatchSurface(const SolidMesh& mesh) : mesh_(&mesh) {}

  void first(double t_min_mm, std::size_t n, SolidBatch& batch) const {
    for (std::size_t i = 0; i < n; ++i) {
      const SurfaceHit hit = mesh_->first(ray_of(batch, i), t_min_mm, batch.t[i]);
      batch.part[i] = hit.part;
      if (hit.part < 0) continue;
      batch.t[i] = hit.t_mm, batch.u[i] = hit.u, batch.v[i] = hit.v;
    }
  }
  void normals(std::size_t n, SolidBatch& batch) const {
    for (std::size_t i = 0; i < n; ++i) {
      const SurfaceHit hit{batch.part[i], batch.t[i], batch.u[i], batch.v[i]};
      if (hit.part < 0) continue;
      const Vec3 at_mm = ray_of(batch, i).at(hit.t_mm);
      const Vec3 outward = mesh_->outward(at_mm, hit), smooth = mesh_->smooth(at_mm, hit);
      batch.nx[i] = outward.x, batch.ny[i] = outward.y, batch.nz[i] = outward.z;
      batch.sx[i] = smooth.x, batch.sy[i] = smooth.y, batch.sz[i] = smooth.z;
    }
  }

 private:
  const SolidMesh* mesh_;
};

/// A body that light goes through: where it stands, and what its surface does.
struct PlacedSolid {
  const Frame &world_from_solid, &solid_from_world;
  SolidFinish finish;
};

/// Light on its way through a body: many rays together.
class SolidFlight {
 public:
  /// Of the rays with numbers `which`, kSolidBatch at most, with a medium each; the same numbers of `out` are
  /// what becomes of them. All must outlive the flight.
  SolidFlight(const SolidKernels& kernels, const PlacedSolid& solid, std::span<const GlassRay> rays,
              std::span<const std::size_t> which, std::span<const MediumView> media,
              std::span<GlassPassage> out)
      : kernels_(&kernels), solid_(solid), rays_(rays), which_(which), media_(media), out_(out) {
    LUCERNA_CHECK(which.size() <= kSolidBatch && media.size() == which.size(), "{} rays, {} media",
                  which.size(), media.size());
  }

  /// Follows all rays, as through_solid does one.
  template <class Surface>
  void run(const Surface& surface) {
    set_out();
    surface.normals(n_, batch_);
    enter();
    for (int i = 0; i < kMaxInsideHits && n_ > 0; ++i) {
      cross();
      std::fill_n(batch_.t, n_, 1e300);
      surface.first(kSolidStart, n_, batch_);
      drop_lost();
      surface.normals(n_, batch_);
    }
    for (std::size_t i = 0; i < n_; ++i) lose(i);
  }

 private:
  /// Sets out, with where the rays meet the surface.
  void set_out();
  /// With the normals there.
  void enter();
  /// Sends all on from the surface; what is outside after that has left.
  void cross();
  /// Gives up what meets no surface.
  void drop_lost();
  void lose(std::size_t i);
  void scatter(std::size_t i);
  void move(std::size_t from, std::size_t to);

  /// What becomes of ray `i` of the batch.
  GlassPassage& passage(std::size_t i) { return out_[which_[number_[i]]]; }
  void finish(std::size_t i) { passage(i).ray = solid_.world_from_solid.ray(ray_of(batch_, i)); }

  const SolidKernels* kernels_;
  PlacedSolid solid_;
  std::span<const GlassRay> rays_;
  std::span<const std::size_t> which_;
  std::span<const MediumView> media_;
  std::span<GlassPassage> out_;
  SolidBatch batch_;
  /// Of the rays that are still on their way, where they stand in `which`.
  std::size_t n_ = 0, number_[kSolidBatch];
  std::vector<Rng> random_;
};

}  // namespace lucerna
