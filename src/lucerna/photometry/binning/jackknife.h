// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/estimate.h"

namespace lucerna {

/// A figure of a whole run and of the run without each of its R replicates in turn: what the jackknife needs
/// (B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, chapter 3). Any function
/// of figures is taken value by value, so errors follow without derivatives, correlations included.
class Jackknife {
 public:
  Jackknife() : Jackknife(std::size_t{0}) {}
  /// Zeros. `replicates` may be 0: the error is not known then.
  explicit Jackknife(std::size_t replicates) : values_(replicates + 1, 0.0) {}
  /// `values`: the whole run's first, then those that leave one replicate out.
  explicit Jackknife(std::vector<double> values);

  std::size_t replicates() const { return values_.size() - 1; }
  double all() const { return values_[0]; }
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }

  /// Adds `factor` times `row`, which is laid out as `values`.
  void add(double factor, std::span<const double> row) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += factor * row[i];
  }

  /// The whole run's value with the jackknife's standard error, sqrt((R - 1) / R * sum (v_r - mean)^2); NaN
  /// for fewer than two replicates.
  Estimate estimate() const;

  /// The same figure R times with noise of its full size: what the run is without a replicate differs by a
  /// quarter of its error only (16 replicates), so a figure that jumps (a crossing where the light runs
  /// level) would not show it. The whole run's value first; then whole run + sqrt(R - 1) (without one - whole
  /// run).
  Jackknife draws() const;
  /// What a function of such draws is as a jackknife: `estimate` gives their scatter.
  static Jackknife from_draws(std::vector<double> values);

  /// The same with its scatter scaled so that `estimate` gives `error`; spread evenly where there is none.
  Jackknife with_error(double error) const;

  /// `f` of each value: f(x) -> double.
  template <class F>
  Jackknife map(const F& f) const {
    Jackknife out(*this);
    for (double& v : out.values_) v = f(v);
    return out;
  }

 private:
  std::vector<double> values_;
};

/// What the even replicates of a figure say by themselves, or the odd ones: the mean of their pseudo-values
/// and its standard error. `values` are laid out as those of a Jackknife of four replicates or more. The two
/// halves of a run are independent: one can choose what the other is asked about.
Estimate half_estimate(std::span<const double> values, bool odd);

/// The standard error of what n rays carried is that of n + 1: replicates of few rays know a variance badly.
/// `ray`: what one effective ray carries, variance over value.
double error_of_rays(double value, double ray);

/// A ratio, value by value; 0 where the denominator is 0.
Jackknife ratio(const Jackknife& numerator, const Jackknife& denominator);

/// The largest of several figures, which errors push up: the largest of noisy values is biased upwards, and
/// the value at the place that other replicates chose (cross-validation: the pseudo-value of replicate r
/// where the run without r is largest) downwards by as much to first order. `estimate` is their midpoint; its
/// error is the jackknife's at the largest, and a twelfth of the square of the two's distance for the
/// midpoint.
struct LargestFigure {
  Estimate estimate;
  /// Which is the largest of the whole run.
  std::size_t index = 0;
  /// The largest of all and without each replicate, moved so that the first is `estimate.mean`.
  Jackknife values;
  /// Which is the largest without each replicate.
  std::vector<std::size_t> index_without;
};
/// `candidates` must not be empty and be of equal replicates. O(candidates * replicates).
LargestFigure largest(std::span<const Jackknife> candidates);

/// Flux by cell, of the whole run and without each replicate.
class JackknifedFlux {
 public:
  JackknifedFlux() = default;
  JackknifedFlux(std::size_t cells, std::size_t replicates)
      : stride_(replicates + 1), values_(cells * stride_, 0.0) {}

  std::size_t cells() const { return stride_ == 0 ? 0 : values_.size() / stride_; }
  std::size_t replicates() const { return stride_ == 0 ? 0 : stride_ - 1; }
  double flux(std::size_t cell) const { return values_[cell * stride_]; }
  std::span<double> row(std::size_t cell) { return std::span(values_).subspan(cell * stride_, stride_); }
  std::span<const double> row(std::size_t cell) const {
    return std::span(values_).subspan(cell * stride_, stride_);
  }
  Jackknife at(std::size_t cell) const { return Jackknife({row(cell).begin(), row(cell).end()}); }
  /// The whole run's flux of all cells.
  std::vector<double> fluxes() const;

 private:
  std::size_t stride_ = 0;
  std::vector<double> values_;
};

}  // namespace lucerna
