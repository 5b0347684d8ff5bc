// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/design/solver/least_squares.h"
#include "lucerna/design/validation/source_etendue.h"

namespace lucerna {

/// Étendue curves are known to a few per cent: so much more flux is granted before a target is called
/// impossible.
inline constexpr double kEtendueTolerance = 1.05;

/// What no mirror of an aperture can beat, whatever its shape (Liouville: light keeps its étendue, a mirror
/// its luminance at best).
struct EtendueLimit {
  /// Étendue that leaves through the opening (the aperture's outline and the source's own cross section)
  /// towards the directions that hold the brighter half of the target, and what the brightest light of the
  /// sources needs for as much flux as that half of the target is to have; mm^2 sr.
  double opening_mm2 = 0.0, etendue_mm2sr = 0.0, needed_mm2sr = 0.0;
  /// The largest share of the sources' flux that can leave with the target's distribution: min over the
  /// brighter parts p of the target of F(étendue of p's directions) / p, F the sources' brightest flux.
  double max_share = 1.0;
  /// Share that the target asks for: its flux in absolute mode, 0 by shape.
  double target_share = 0.0;
  /// What cannot be, in one sentence each, with the figure that limits it; empty if nothing forbids the
  /// target.
  std::vector<std::string> statements;
};

/// Bounds a target in bins over directions: `target` as shares of the sources' flux (any scale by shape).
/// `min_efficiency` (0: none) is a limit that the sources' share must reach. Rays beyond the first 2^18
/// are not used. Bins on a plane have no bound here (no statements): the plane is near. The bound is on the
/// light that leaves through the opening; light that passes beside the mirror has étendue of its own. Cost:
/// that of the curves that it asks `etendue` (of the same rays) for.
EtendueLimit etendue_limit(const DesignRays& rays, SourceEtendue& etendue, const DesignShape& shape,
                           const TentBins& bins, const Eigen::VectorXd& target, TargetMode mode,
                           double min_efficiency = 0.0);

/// The largest share of the flux whose brightest part fits into an étendue in mm^2 sr.
double share_in(const EtendueCurve& curve, double etendue_mm2sr);
/// Area in mm^2 that light leaves through: the aperture's outline, and half the surface of the sphere about
/// the rays' starts that holds 98 % of them, where light starts in front of it.
double opening_mm2(const DesignShape& shape, const RayBlock& rays);

}  // namespace lucerna
