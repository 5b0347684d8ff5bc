// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/intensity.h"

namespace lucerna {

/// Some light in a direction.
struct DirectedFlux {
  Direction direction;
  double flux = 0.0;
};

/// Where a target is compared: the window that holds `share` of its light, in bins.
struct WindowOptions {
  int count = 48;
  double share = 0.99;
};

/// The square of direction cosines about the light's mean direction (about `fallback` if the mean is shorter
/// than 0.2) whose half width holds `share` of all light; light from behind can never be in it. The window's
/// x axis stays as near to the frame's x as can be. Throws InputError if there is no light, or less than half
/// of it on the axis' side of the sphere.
TentBins square_window(std::span<const DirectedFlux> light, const Direction& fallback,
                       const WindowOptions& options = {});

/// Rings of gamma about `axis` that hold `share` of the light.
TentBins ring_window(std::span<const DirectedFlux> light, const Direction& axis,
                     const WindowOptions& options = {});

/// An intensity distribution as light in small cells of half a degree.
std::vector<DirectedFlux> directed_flux(const IntensityDistribution& distribution);

/// The same window, wider by `factor` (as far as the half sphere, or the sphere for rings; a plane has no
/// end), in other bins.
TentBins rebinned(const TentBins& bins, double factor, int count);

}  // namespace lucerna
