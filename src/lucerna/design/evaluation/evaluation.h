// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/evaluation/sparse_jacobian.h"
#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/scene.h"

namespace lucerna {

/// Bins by parameters; row by row, as the rays touch it.
using BinJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A good EvaluationOptions::rim_mm, over the mirror's radius.
inline constexpr double kRimShare = 0.02;

/// What one evaluation traces.
struct EvaluationOptions {
  std::uint64_t rays = 1 << 16;
  /// Also the derivatives; twice to seven times the time, the more so the wider the source.
  bool derivatives = true;
  /// The derivatives as `Evaluation::rows` and not as `jacobian`; free forms only.
  bool sparse = false;
  /// Sparse derivatives are those of the light of the first so many rays (kDesignTasks blocks at least); 0:
  /// of all. A search needs them less exactly than the light, and they take most of the time. On a device
  /// they are always those of all.
  std::uint64_t derivative_rays = 0;
  /// Light that misses the mirror counts too (it does in a luminaire; the hidden-reflector suite leaves it
  /// out, so that it cannot flatter the error).
  bool direct_light = true;
  /// Derivatives include the light that crosses the rims (outline and hole) as the surface moves, estimated
  /// from the hits in a strip of this width inside them. 0 leaves it out: then the derivatives are exactly
  /// those of the given rays' sums.
  double rim_mm = 0.0;
};

/// The far field of one shape in the bins, as shares of the sources' flux.
struct Evaluation {
  Eigen::VectorXd flux;
  /// Variance of each entry of `flux` from the scatter of the few independent streams: rough for one bin,
  /// good in sums over many.
  Eigen::VectorXd variance;
  /// d flux / d parameter; empty unless asked for.
  BinJacobian jacobian;
  /// The same where it was asked for sparse.
  SparseJacobian rows;
  /// SparseDerivatives::noise of `rows`.
  Eigen::VectorXd rows_noise;
  /// Shares of the sources' flux: light that leaves after, and without, a reflection; that mirrors absorbed;
  /// that met the back; that was given up; that bodies absorbed (DesignRays::shade_by).
  double reflected = 0.0, direct = 0.0, absorbed = 0.0, back = 0.0, lost = 0.0, bodies = 0.0;
  std::uint64_t rays = 0;
};

/// Traces the first `options.rays` rays through the shape into the bins (whose frame must map into the
/// mirror's), with exact pathwise derivatives through all reflections: for every ray, tent weights are
/// differentiated by the leaving direction and that by the coefficients that each hit touches. Rays that
/// change from hitting to missing have measure zero among given rays but not in the mean: at rims they are
/// counted by EvaluationOptions::rim_mm, at edges of the mirror's own shadow they are left out. A reflectance
/// that depends on the angle is taken at the ray's own angle, its change is left out. Bodies that shade the
/// rays take light where it hits them first; light that crosses the edge of a body as the surface moves, and
/// how light moves that a body reflected, are left out of the derivatives. `rays` must hold that many. Rays
/// of one task are summed in order, tasks are added in order: the same bits for any number of threads.
/// Where `rays` are shared with peers, each traces some of the tasks and all return the same bits; then the
/// call is collective. Thread safe without peers.
Evaluation evaluate(const DesignShape& shape, const Reflectance& reflectance, const DesignRays& rays,
                    const TentBins& bins, const EvaluationOptions& options);

}  // namespace lucerna
