// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/geometry.h"

namespace lucerna {

/// A mass at a direction.
struct DirectionMass {
  Direction direction;
  double mass = 0.0;
};

/// Cost of moving `from` onto `to` at least cost, a unit of mass over an angle costing that angle in radians:
/// Wasserstein-1 on the sphere times the mass. Both sides are scaled to the mean of their sums first. Exact
/// up to rounding, by the network simplex method on the dense bipartite graph (Ahuja, Magnanti, Orlin,
/// "Network Flows", 1993, chapter 11); supplies are perturbed by 1e-9 of their size against cycling. Masses
/// must be positive; empty sides cost 0. Time about (m + n) m n / 1e3, memory 8 m n bytes.
double transport_cost_rad(const std::vector<DirectionMass>& from, const std::vector<DirectionMass>& to);

/// At most `limit` masses that stand for `masses`: groups are split at the median of their widest axis, those
/// that hold most mass times extent first; a group becomes its mean direction. As many groups as masses
/// changes nothing.
std::vector<DirectionMass> clustered(std::vector<DirectionMass> masses, std::size_t limit);

}  // namespace lucerna
