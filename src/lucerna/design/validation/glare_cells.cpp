// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/glare_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr double kGlareRing_deg = 5.0;
constexpr double kMostSectors = 12.0;

}  // namespace

GlareCells::GlareCells(const Frame& world_from_mirror, double beyond_deg)
    : mirror_from_world_(world_from_mirror.inverse()), beyond_deg_(beyond_deg) {
  const long count = std::max(1L, std::lround((180.0 - beyond_deg) / kGlareRing_deg));
  const double high = radians(180.0 - beyond_deg) / static_cast<double>(count);
  std::size_t first = 0;
  for (long k = 0; k < count; ++k) {
    const double near = radians(beyond_deg) + high * static_cast<double>(k);
    const double around = 2.0 * std::numbers::pi * std::sin(near + 0.5 * high);
    const auto sectors = static_cast<std::size_t>(std::clamp(std::floor(around / high), 1.0, kMostSectors));
    const double sr = 2.0 * std::numbers::pi * (std::cos(near) - std::cos(near + high));
    rings_.push_back({first, sectors, sr / static_cast<double>(sectors)});
    first += sectors;
  }
}

void GlareCells::add(const Vec3& direction, double flux, std::span<double> sums) const {
  const Vec3 d = mirror_from_world_.vector(direction);
  const double off_deg = degrees(std::atan2(std::hypot(d.x, d.y), d.z)) - beyond_deg_;
  if (off_deg < 0.0) return;
  const auto place = [](double share, std::size_t n) {
    return std::min(static_cast<std::size_t>(share * static_cast<double>(n)), n - 1);
  };
  const Ring& ring = rings_[place(off_deg / (180.0 - beyond_deg_), rings_.size())];
  const double turn = 0.5 + std::atan2(d.y, d.x) / (2.0 * std::numbers::pi);
  sums[ring.first + place(turn, ring.sectors)] += flux;
}

Estimate GlareCells::brightest(std::span<const BoxSums> replicates,
                               std::vector<double> BoxSums::*light) const {
  Estimate most;
  for (const Ring& ring : rings_) {
    for (std::size_t cell = ring.first; cell < ring.first + ring.sectors; ++cell) {
      const Estimate e =
          replicate_share(replicates, [&](const BoxSums& r) { return (r.*light)[cell] / ring.measure_sr; });
      if (e.mean > most.mean) most = e;
    }
  }
  return most;
}

}  // namespace lucerna
