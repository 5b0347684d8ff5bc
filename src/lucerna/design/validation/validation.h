// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/parallel/peers.h"
#include "lucerna/design/validation/glare_cells.h"
#include "lucerna/design/validation/zone_check.h"
#include "lucerna/progress.h"
#include "lucerna/scene.h"

namespace lucerna {

/// Who finds the hits: Embree where it was built in, or the library's own tree.
enum class HitEngine { best, embree, tree };

struct ValidationOptions {
  /// Of the rays; they are others than those of any fit, also with the same seed.
  std::uint64_t seed = 1;
  /// Rays that are traced, and what they are doubled to until the floor at n = 48 is half of the excess.
  /// Fewer than `min_rays`, but 2^20, are enough where the excess is also known to a hundredth of itself.
  std::uint64_t min_rays = std::uint64_t{1} << 24;
  std::uint64_t max_rays = std::uint64_t{1} << 27;
  /// Time only stops: fewer rays are traced than the above where they would take longer (at least 2^18).
  double max_s = std::numeric_limits<double>::infinity();
  /// Of the meshes; absent: mesh_tolerance of the boxes. Flat facets blur the light by about their angle to
  /// the surface; what these do to the error is in docs/benchmarks/design.md.
  std::optional<CadTolerance> tolerance;
  HitEngine engine = HitEngine::best;
  /// Zones whose light is counted too; then rays are also doubled until every zone's verdict is clear. Null:
  /// none. Must outlive the call.
  const ZoneCells* zones = nullptr;
  /// Cells whose light is counted too (BoxSums::glare); null: none. Must outlive the call.
  const GlareCells* glare = nullptr;
  /// Processes that validate the same mirror and share its rays (peers.h), by replicates; null: this one
  /// alone.
  Peers* peers = nullptr;
};

/// What a mirror does with light, found by code that shares nothing with the fit.
struct Validation {
  DesignError error;
  /// ValidationOptions::zones as found.
  std::vector<ZoneCheck> zones;
  /// Shares of the sources' flux: what leaves; what the mirrors' faces, their backs and bodies absorb; rays
  /// that were given up after 100 reflections.
  Estimate efficiency, absorbed, back, bodies, lost;
  std::uint64_t rays = 0;
  /// The sums that the above were made of, 16 replicates.
  std::vector<BoxSums> replicates;
  std::size_t triangles = 0;
  /// The tolerance that the mesh keeps.
  CadTolerance tolerance;
  bool embree = false;
  /// Seconds of all of it, and of making the meshes, which costs the same for any number of rays.
  double seconds = 0.0, mesh_s = 0.0;
};

/// Traces the scene's sources through its mirrors as triangles (cad_mesh_within, as the STL export has them),
/// and its bodies, into the cells of the boxes: 16 replicates of independent Owen-scrambled Sobol sequences
/// (rays of files come once each), reflections up to 100, mirrors absorb on their backs, light that hits
/// nothing counts as direct. Slope errors of mirrors and bodies are drawn as `trace` draws them. `target` is
/// flux per cell (box_target). The same bits for any number of threads where time does not stop it. Progress
/// phase "validate", in rays; stops early with what there is when asked to. Throws InputError on a bad scene,
/// one with cover glasses or solids, or engine `embree` in a build without.
Validation validate(const Scene& scene, const ErrorBoxes& boxes, std::span<const double> target,
                    TargetMode mode, const ValidationOptions& options = {},
                    Progress& progress = no_progress());

}  // namespace lucerna
