// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/source/adaptive/charts/chart_batch.h"
#include "lucerna/source/adaptive/search/support_fit.h"

namespace lucerna {

/// Nats that a split of a quick density must gain.
inline constexpr double kQuickPenaltyNats = 6.0;

/// A quick density of some rays on a support: one tree a chart, or the mean of several. What supports are
/// evaluated by and what tells overlapping layers apart. Immutable once made; thread safe.
class FittedSupport {
 public:
  /// Nothing at all.
  FittedSupport() = default;
  /// Only rays that the support carries are in it; `weight` as for project().
  FittedSupport(const RayBlock& rays, std::span<const float> weight, BoundedSupport on, double tolerance_mm,
                int trees = 1);

  /// Densities of the first lines of a batch, as many as `out` holds, 1/(mm^2 sr) times carried(): they
  /// integrate to that share. `lines` are in support()'s numbers.
  void densities(const ChartBatch& lines, std::span<double> out) const;
  /// The same for rays `first`, `first + 1` ... of a block.
  void densities(const RayBlock& rays, std::size_t first, std::span<double> out) const;
  const Support& support() const { return on_.support; }
  /// Share of the weight that the support carries.
  double carried() const { return carried_; }
  /// Étendue of the boxes about its rays.
  double volume() const { return volume_; }
  std::size_t leaves() const { return leaves_; }

 private:
  struct Chart {
    std::uint32_t chart;
    double share;
    std::vector<TreeLookup> trees;
  };
  BoundedSupport on_;
  double carried_ = 0.0, volume_ = 0.0;
  std::size_t leaves_ = 0;
  std::vector<Chart> charts_;
};

/// The plain density that everything is compared with: lines about the focus, with a hundredth of the light
/// spread evenly so that nothing is impossible.
class BackgroundDensity {
 public:
  BackgroundDensity(const RayBlock& rays, std::span<const float> weight, const Vec3& focus_mm,
                    double tolerance_mm);
  /// Densities of the lines of rays `first`, `first + 1` ... of a block.
  void densities(const RayBlock& rays, std::size_t first, std::span<double> out) const;

 private:
  FittedSupport fitted_;
  double even_ = 0.0;
};

}  // namespace lucerna
