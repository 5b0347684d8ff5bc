// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/problem/target.h"
#include "lucerna/design/validation/error_boxes.h"
#include "lucerna/estimate.h"

namespace lucerna {

/// What rays of one replicate leave: flux by cell of ErrorBoxes, and by how they ended, in any one unit.
struct BoxSums {
  /// Flux that leaves the luminaire, and the part of it that met no mirror.
  std::vector<double> flux, direct;
  /// Flux that leaves by measuring cell of the target's zones (zone_cells.h), and the part of it that met
  /// nothing; empty without zones.
  std::vector<double> zones, zones_direct;
  /// Flux that leaves by cell of GlareCells, and the part of it that met nothing; empty without.
  std::vector<double> glare, glare_direct;
  /// All ends of the emitted flux: emitted = out_direct + out_reflected + absorbed + back + bodies + lost.
  double emitted = 0.0, out_direct = 0.0, out_reflected = 0.0;
  double absorbed = 0.0, back = 0.0, bodies = 0.0, lost = 0.0;
  std::uint64_t rays = 0;

  BoxSums& operator+=(const BoxSums& other);
};

/// What `flux` gives, as a share of the emitted flux: its mean over at least two replicates.
template <class Flux>
Estimate replicate_share(std::span<const BoxSums> replicates, const Flux& flux) {
  std::vector<double> shares;
  for (const BoxSums& r : replicates) shares.push_back(flux(r) / r.emitted);
  return mean_estimate(shares);
}

/// What cells of the boxes hold within the rectangle; 0 where there are none.
double flux_inside(std::span<const double> cells);

/// The target's flux per cell of the boxes: in its own unit by shape, as shares of `source_flux` in absolute
/// mode. Throws InputError where the rectangle has no light.
std::vector<double> box_target(const ErrorBoxes& boxes, const DesignTarget& target, double source_flux);

/// The error of the light in `replicates` (independent, of equally many rays each; shares of what each
/// emitted are taken) against `target` (flux per cell, box_target). With one replicate the noise counts as 0
/// and standard errors are NaN. In shape mode each n has its own best scale: the one that makes the excess
/// smallest. The excess' standard error is from the scatter of the replicates to second order (their pairs),
/// about floor * (2 / cells)^(1/4) where there is only noise. Cost: replicates^2 * cells.
DesignError box_error(const ErrorBoxes& boxes, std::span<const double> target,
                      std::span<const BoxSums> replicates, TargetMode mode);

/// A light distribution and the standard errors of its independent values (layout of `cd`; empty: exact).
struct KnownDistribution {
  const IntensityDistribution& distribution;
  std::span<const double> standard_error_cd{};
};

/// The error of one light distribution against another as target, in the boxes of `reference`, by shape or
/// absolute; the floor is what the errors of both give. Throws InputError as target_rectangle, and where the
/// units differ in absolute mode.
DesignError box_error(const KnownDistribution& reference, const KnownDistribution& test, TargetMode mode);

}  // namespace lucerna
