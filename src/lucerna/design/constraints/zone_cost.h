// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "lucerna/design/problem/zone_cells.h"
#include "lucerna/design/solver/sparse_equations.h"

namespace lucerna {

/// The zones of a target as a fit sees them.
struct ZoneBands {
  std::shared_ptr<const ZoneCells> cells;
  /// Of all sources: light in bins is in shares of it.
  double source_flux = 1.0;
  Frame mirror_from_world;
  /// Without a file the target's distribution is only a guide: its squared error counts little.
  bool only = false;
};

/// How zones count on one level of a search: bounds the more the finer it is, a guide the less.
struct ZoneStage {
  double weight = 1.0;
  double guide_weight = 1.0;
};
ZoneStage zone_stage(int level);

/// What zones cost at a light in smooth bins. The intensity in a measuring cell is the mean over it of the
/// bins' intensities, bilinear between their centres. From a margin inside each bound on, the square of what
/// is missing to that margin, over the margin, counts; a zone's cells share weight / sqrt(cells). The margin
/// is 2 % of the bound and the counting noise of the cell's rays (15 % at most), so that a bound which the
/// fit holds is held by other rays too. A uniformity is one more linear bound, on the difference between a
/// cell and a multiple of the mean (or of the cell that is brightest now). Cells that no bin sees (behind the
/// target's hemisphere) are not fitted. Immutable, thread safe.
class ZoneCost {
 public:
  /// `bins` in the mirror's frame; `rays`: of the evaluations.
  ZoneCost(const ZoneBands& bands, const TentBins& bins, std::uint64_t rays, double weight);

  double cost(const Evaluation& light) const;
  /// Adds cost, gradient and Hessian of an evaluation with `rows`.
  void add_to(const Evaluation& light, SparseEquations& equations) const;
  /// Mean intensity or illuminance per cell, cd or lx; NaN where no bin sees it.
  Eigen::VectorXd values(const Evaluation& light) const;

 private:
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  /// One bound of one zone at a light: the cells that break it, and what they are compared with.
  struct Broken {
    std::vector<Eigen::Index> cells;
    Eigen::VectorXd residual, by_cell;
    /// Weights over all cells of what the bound is a multiple of, and d residual / d that; empty: absolute.
    Eigen::VectorXd reference, by_reference;
  };
  Broken broken(std::size_t zone, const ZoneBound& bound, const Eigen::VectorXd& x) const;
  /// Weights over cells of what a bound is a multiple of; empty for absolute bounds.
  Eigen::VectorXd reference(std::size_t zone, const ZoneBound& bound, const Eigen::VectorXd& x) const;
  double margin(std::size_t zone, const ZoneBound& bound, std::size_t cell) const;
  void add(const Broken& b, const Evaluation& light, SparseEquations& equations) const;

  std::shared_ptr<const ZoneCells> cells_;
  double source_flux_, weight_;
  std::uint64_t rays_;
  /// Cells by bins: intensity from flux.
  Matrix mean_;
  std::vector<char> seen_;
};

}  // namespace lucerna
