// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/engines/ray_colours.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/engines/solid_tracer.h"

namespace lucerna {

/// How the bodies of a scene are followed: as triangles with smooth normals (`surface_mesh`), which no fit
/// has seen, or as they are. Bodies with a face are never made of triangles: they would be too many.
enum class LensSurface { triangles, exact };

/// Blocks of rays of a scene's sources on their way through its solids, with all reflections at all
/// boundaries by chance. Immutable and thread safe.
class LensBlocks {
 public:
  /// Throws InputError as `check(Scene)` does. Keeps `scene`.
  LensBlocks(const Scene& scene, LensSurface surface, std::uint64_t seed);

  /// Draws block `block` into `rays` and follows it. `sums` is told what becomes of each ray's flux, in units
  /// of the mean ray: emitted(flux), absorbed(flux), lost(flux) and left(ray, flux, surfaces), with how many
  /// points of surfaces the ray has met, the last of them its origin.
  template <class Sums>
  void follow(std::uint64_t block, RayBlock& rays, Sums& sums) const {
    for (const SourceRun& run : numbering_.runs(block * kBlockRays, (block + 1) * kBlockRays)) {
      const PlacedSource& source = scene_.sources[run.source];
      const Sequence sequence(SequenceKind::sobol, run.sequence_seed);
      rays.resize(run.count, 0);
      source.rays->emit(sequence, run.first, rays);
      std::vector<float> wavelength_nm(run.count);
      colours_.emit(run.source, sequence, run.first, wavelength_nm);
      for (std::size_t i = 0; i < run.count; ++i) {
        const double flux = numbering_.ray_flux(run.source) * static_cast<double>(rays.weight[i]);
        follow(source.world_from_source.ray(rays.ray(i)), flux, {run.sequence_seed, run.first + i, 0},
               wavelength_nm[i], sums);
      }
    }
  }

 private:
  /// Times that a ray may meet solids from outside.
  static constexpr int kMostPassages = 100;
  static constexpr double kNoLimit_mm = std::numeric_limits<double>::max();

  template <class Sums>
  void follow(Ray ray, double flux, ReflectionKey key, float wavelength_nm, Sums& sums) const {
    sums.emitted(flux);
    for (int surfaces = 0;; ++key.bounce) {
      const auto hit = solids_.first_hit(ray, kNoLimit_mm, key.bounce > 0);
      if (!hit) return sums.left(ray, flux, surfaces);
      const GlassPassage way = solids_.pass(ray, *hit, key, wavelength_nm, [&](const Vec3&) { ++surfaces; });
      sums.absorbed(flux * (1.0 - way.throughput));
      flux *= way.throughput;
      if (way.lost || key.bounce == kMostPassages) return sums.lost(flux);
      ray = way.ray;
    }
  }

  const Scene& scene_;
  RayNumbering numbering_;
  SolidTracer solids_;
  RayColours colours_;
};

}  // namespace lucerna
