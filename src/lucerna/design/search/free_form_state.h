// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/design/initial/transport_guess.h"

namespace lucerna {

/// Rough, fine, to the end; the last is gone through again with more rays.
inline constexpr int kRoughLevel = 0, kFineLevel = 1, kEndLevel = 2, kMoreRaysLevel = 3, kFreeFormLevels = 4;

/// A candidate that was fitted on a level.
struct FreeFormSnapshot {
  int candidate = -1, level = -1;
  /// What it began with; none: the given mirror, or what an approach made of it.
  TransportChoice transport{};
  /// What candidates are compared by: the squared error less its noise (a share of it while the fit is
  /// rough), and what lost light, limits and roughness cost.
  double cost = 0.0;
  /// Relative error, noise taken out.
  double error = 0.0;
  /// The cost after the first few steps of the level; 0 before.
  double early_cost = 0.0;
  /// Root of the whole cost, missing light included, over the noise.
  double error_to_noise = 0.0;
  int intervals_x = 1, intervals_y = 1;
  /// Bins across the widened rectangle: the level's, or fewer. And what of the derivatives would be noise in
  /// them, over the rest, were they those of all rays.
  int bins = 1;
  double derivative_noise = 0.0;
  /// FreeFormLevel::derivative_rays of the level.
  std::uint64_t derivative_rays = 0;
  std::vector<double> parameters;
  bool exists() const { return candidate >= 0; }
};

/// All that the next step depends on; a checkpoint holds exactly this.
struct FreeFormState {
  /// The candidate at work; without parameters: none, the next is chosen.
  FreeFormSnapshot now;
  int step = 0, refused = 0;
  double lambda = 1e-2;
  std::vector<double> costs;
  /// Candidates begun so far, and how many in turn had no start.
  int begun = 0, failed = 0;
  int evaluations = 0;
  std::uint64_t total_rays = 0;
  /// What came to the end of a level, in order; only snapshots that may still be taken up keep parameters.
  std::vector<FreeFormSnapshot> done;
};

}  // namespace lucerna
