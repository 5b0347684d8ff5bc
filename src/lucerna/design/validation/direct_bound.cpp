// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/direct_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lucerna {

namespace {

/// A box of the rectangle: its target, its solid angle or area, and the direct light that is surely there.
struct Box {
  double target, measure, direct;
};

std::vector<Box> boxes_with_direct_light(const ErrorBoxes& boxes, std::span<const double> target,
                                         std::span<const BoxSums> replicates) {
  std::vector<Box> out;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    if (!(boxes.measure()[b] > 0.0)) continue;
    const Estimate direct = replicate_share(replicates, [&](const BoxSums& r) { return r.direct[b]; });
    out.push_back({target[b], boxes.measure()[b], std::max(0.0, direct.mean - 2.0 * direct.standard_error)});
  }
  return out;
}

double squared(double deviation, double measure) { return deviation * deviation / measure; }

/// The least squared deviation of light that is at least `scale` times the direct light in each box and
/// `total` in all: the rest is poured to one level above or below the target.
double poured(const std::vector<Box>& boxes, double scale, double total) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0, target = 0.0, measure = 0.0;
  for (const Box& b : boxes) {
    low = std::min(low, (scale * b.direct - b.target) / b.measure);
    target += b.target;
    measure += b.measure;
  }
  high = std::max(low, (total - target) / measure) + 1e-300;
  low = std::min(low, high);
  const auto light = [&](const Box& b, double level) {
    return std::max(scale * b.direct, b.target + level * b.measure);
  };
  for (int i = 0; i < 100; ++i) {
    const double level = 0.5 * (low + high);
    double sum = 0.0;
    for (const Box& b : boxes) sum += light(b, level);
    (sum < total ? low : high) = level;
  }
  double square = 0.0;
  for (const Box& b : boxes) square += squared(light(b, high) - b.target, b.measure);
  return square;
}

/// The same with the best scale, a convex function of it; `share` is the light in all at scale 1.
double min_poured(const std::vector<Box>& boxes, double share, double target) {
  double low = 0.0, high = 2.0 * target / share;
  for (int i = 0; i < 60; ++i) {
    const double s = low + (high - low) / 3.0, t = high - (high - low) / 3.0;
    const bool below = poured(boxes, s, s * share) < poured(boxes, t, t * share);
    (below ? high : low) = below ? t : s;
  }
  const double s = 0.5 * (low + high);
  return poured(boxes, s, s * share);
}

}  // namespace

double direct_light_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                          std::span<const BoxSums> replicates) {
  const std::vector<Box> lit = boxes_with_direct_light(boxes, target, replicates);
  double norm2 = 0.0, total = 0.0, over = 0.0, direct = 0.0;
  for (const Box& b : lit) {
    norm2 += squared(b.target, b.measure);
    total += b.target;
    direct += b.direct;
    over += squared(std::max(0.0, b.direct - b.target), b.measure);
  }
  if (!(direct > 0.0)) return 0.0;
  if (mode == TargetMode::absolute) return std::sqrt(over / norm2);
  const double share = replicate_share(replicates, [](const BoxSums& r) { return flux_inside(r.flux); }).mean;
  return std::sqrt(min_poured(lit, share, total) / norm2);
}

}  // namespace lucerna
