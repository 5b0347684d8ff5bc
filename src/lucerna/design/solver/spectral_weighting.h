// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/evaluation/tent_bins.h"

namespace lucerna {

/// Light with its large-scale structure brought out: in the cosine transform of the bins' densities (over the
/// root of their measure, as residuals are weighted) the mode of i and j half waves across the window is
/// multiplied by 1 / sqrt((1 + (i / waves)^2) (1 + (j / waves)^2)). Unlike a blur of the same reach nothing
/// is lost, but light in the wrong place costs the more the farther it has to go: least squares finds its way
/// from much farther off, and large scales have the least noise. For square bins and planes. Immutable,
/// thread safe.
class SpectralWeighting {
 public:
  /// waves > 0; the more, the less is changed.
  SpectralWeighting(const TentBins& bins, double cutoff);

  /// Of one figure per bin, and of bins by parameters.
  Eigen::VectorXd flux(const Eigen::VectorXd& flux) const;
  BinJacobian jacobian(const BinJacobian& jacobian) const;

  /// Flux and derivatives; the rest as it was.
  Evaluation operator()(Evaluation e) const;

 private:
  /// One axis' share, symmetric; roots of the bins' measures.
  Eigen::MatrixXd axis_;
  Eigen::VectorXd root_;
};

}  // namespace lucerna
