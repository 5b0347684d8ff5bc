// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/engines/faced_body.h"
#include "lucerna/trace/engines/solid_flight.h"
#include "lucerna/trace/engines/solid_mesh.h"
#include "lucerna/trace/kernels/revolved_tree.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// Rays through the clear bodies of a scene. Immutable and thread safe.
class SolidTracer {
 public:
  /// Throws InputError as `check(Solid)` does.
  explicit SolidTracer(const std::vector<Solid>& solids);

  bool empty() const { return solids_.empty(); }

  /// The first surface within (0, t_max_mm) of a ray in the luminaire frame. `started`: it comes from
  /// something that it met before, and is outside of all bodies.
  std::optional<GlassHit> first_hit(const Ray& ray, double t_max_mm, bool started) const;

  /// What becomes of the ray there; `key.bounce` counts all that it met before, a body once. `wavelength_nm`
  /// counts where the body disperses; not above 0: not known. `visit` sees every point of the surface on its
  /// way.
  GlassPassage pass(const Ray& ray, const GlassHit& hit, const ReflectionKey& key, float wavelength_nm,
                    const std::function<void(const Vec3&)>& visit = {}) const;

  /// The same of many rays, faster where vectors follow them: about a third of the time. Hits within
  /// t_max_mm[i] take the place of what is in `hits`, and of t_max_mm[i].
  void first_hits(std::span<const Ray> rays, bool started, std::span<double> t_max_mm,
                  std::span<std::optional<GlassHit>> hits) const;
  /// Of the rays that hit bodies, which are numbered from `first_solid` on; others stay as they are in `out`.
  void pass(std::span<const GlassRay> rays, std::size_t first_solid, std::span<GlassPassage> out) const;

 private:
  /// A body by its outline, with a face at its top or not, or of triangles.
  struct Traced {
    MediumView medium;
    std::shared_ptr<const Dispersion> dispersion;
    std::unique_ptr<const RevolvedTree> revolved;
    std::unique_ptr<const FacedBody> faced;
    std::unique_ptr<const SolidMesh> mesh;
    Frame world_from_solid, solid_from_world;
    /// What scatters, and where: by parts of the surface, empty for everywhere.
    Scatter scatter;
    std::vector<std::uint8_t> rough;

    MediumView medium_at(float wavelength_nm) const;
    SolidFinish finish() const;
    /// Calls `use` with the surface, in the body's frame.
    template <class Use>
    auto with_surface(const Use& use) const {
      if (mesh != nullptr) return use(*mesh);
      return faced != nullptr ? use(*faced) : use(RevolvedSurface{revolved->view()});
    }
    /// The same of what takes many rays.
    template <class Use>
    void with_batch_surface(const Use& use) const {
      if (mesh != nullptr) {
        use(MeshBatchSurface(*mesh));
      } else if (faced != nullptr) {
        use(FacedBatchSurface(*faced, best_solid_kernels()));
      } else {
        use(RevolvedBatchSurface(*revolved, best_solid_kernels()));
      }
    }
  };

  void find_surfaces(std::size_t solid, std::span<const Ray> rays, bool started, std::span<double> t_max_mm,
                     std::span<std::optional<GlassHit>> hits) const;
  void pass_solid(std::size_t solid, std::span<const GlassRay> rays, std::span<const std::size_t> which,
                  std::span<GlassPassage> out) const;

  std::vector<Traced> solids_;
};

}  // namespace lucerna
