// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/outside_weight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lucerna/design/validation/box_error.h"

namespace lucerna {

namespace {

/// Of a target that is even up to its edges; and edges that are so dark count as dark.
constexpr double kOfEvenLight = 0.04, kDarkEdge = 0.1;

/// The mean brightness of the boxes along the rectangle's edges, over that of all.
double edge_brightness(const DesignTarget& target) {
  const ErrorBoxes boxes(target_rectangle(target));
  const std::vector<double> flux = box_target(boxes, target, 1.0);
  double edges = 0.0, edges_measure = 0.0, all = 0.0, all_measure = 0.0;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    constexpr std::size_t kLast = kErrorBoxes - 1;
    const std::size_t column = b % kErrorBoxes, row = b / kErrorBoxes;
    all += flux[b];
    all_measure += boxes.measure()[b];
    if (column % kLast != 0 && row % kLast != 0) continue;
    edges += flux[b];
    edges_measure += boxes.measure()[b];
  }
  return edges / edges_measure / (all / all_measure);
}

}  // namespace

double outside_weight(const DesignTarget& target) {
  const double bright = (edge_brightness(target) - kDarkEdge) / (1.0 - kDarkEdge);
  return std::pow(kOfEvenLight, std::clamp(bright, 0.0, 1.0));
}

}  // namespace lucerna
