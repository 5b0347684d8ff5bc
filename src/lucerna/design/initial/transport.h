// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lucerna/design/evaluation/window.h"

namespace lucerna {

/// Polar radii of mirrors, or of the faces by which light leaves a medium, that throw a point source's light
/// as prescribed: entropic optimal transport between directions of the source and prescribed ones, with the
/// cost -log(1 - k d . o), k = 1 for mirrors (Wang 2004, doi 10.1007/s00526-003-0239-4) and the index beyond
/// over that of the medium for its faces (Gutierrez and Huang 2009, doi 10.1007/s00205-008-0165-x), by
/// Sinkhorn's iteration with absorbed scalings (Schmitzer 2019, doi 10.1137/16M1106018) while the entropy
/// falls. `sign` +1: the mirror is the inner envelope of paraboloids
/// and its rays cross; -1: the outer one, whose rays spread. Immutable after it is made, thread safe.
class PointTransport {
 public:
  /// Both lists need light; `entropy` is where the iteration ends (the cost's blur: about the product of the
  /// two lists' cell widths, in rad^2). With `guess`, potentials of a transport to the same directions that
  /// differs little, the entropy begins near its end: about half of the products. Cost: some hundred products
  /// of a vector with the matrix of all pairs.
  /// `ratio`: k above, at most 1.
  PointTransport(const std::vector<DirectedFlux>& from, std::vector<DirectedFlux> to, double sign,
                 double entropy, const Eigen::VectorXf* guess = nullptr, double ratio = 1.0);

  /// Of each prescribed direction: a guess for another transport.
  const Eigen::VectorXf& potentials() const { return dual_; }

  /// Polar radius towards a direction from the source, up to a common factor.
  double radius(const Direction& towards) const;

 private:
  std::vector<DirectedFlux> to_;
  double sign_, entropy_;
  float ratio_;
  Eigen::VectorXf dual_;
  Eigen::VectorXf potential_;  ///< the same over the entropy, with the logarithm of the share
  Eigen::Matrix<float, Eigen::Dynamic, 3> directions_;
};

}  // namespace lucerna
