// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

#include "lucerna/design/lens/entry_face.h"

namespace lucerna {

/// A cavity, and how far from the source the free face over it begins: over the distance that it has.
struct CavityTrial {
  Cavity cavity;
  double distance = 1.0;
  double cost = std::numeric_limits<double>::infinity();
};

/// What a trial comes to, whose cost is not known yet: infinite where there is no such lens; nothing where
/// the search is to end.
using CavityCost = std::function<std::optional<double>(const CavityTrial&)>;

/// The best that is found: of a grid of radii and depths, the flat base among them, and of steps from the
/// best of these. Costs are asked for one after the other; `max_trials` of them at most are finite.
CavityTrial search_cavity(const CavityRange& range, const CavityCost& cost, std::size_t max_trials);

}  // namespace lucerna
