// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/glare_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr double kGlareRing_deg = 5.0;
constexpr std::size_t kGlareSectors = 12;

}  // namespace

GlareCells::GlareCells(const Frame& world_from_mirror, double beyond_deg)
    : mirror_from_world_(world_from_mirror.inverse()),
      beyond_deg_(beyond_deg),
      rings_(static_cast<std::size_t>(std::max(1L, std::lround((180.0 - beyond_deg) / kGlareRing_deg)))) {}

std::size_t GlareCells::size() const { return rings_ * kGlareSectors; }

void GlareCells::add(const Vec3& direction, double flux, std::span<double> sums) const {
  const Vec3 d = mirror_from_world_.vector(direction);
  const double off_deg = degrees(std::atan2(std::hypot(d.x, d.y), d.z)) - beyond_deg_;
  if (off_deg < 0.0) return;
  const auto place = [](double share, std::size_t n) {
    return std::min(static_cast<std::size_t>(share * static_cast<double>(n)), n - 1);
  };
  const double turn = 0.5 + std::atan2(d.y, d.x) / (2.0 * std::numbers::pi);
  sums[place(off_deg / (180.0 - beyond_deg_), rings_) * kGlareSectors + place(turn, kGlareSectors)] += flux;
}

Estimate GlareCells::brightest(std::span<const BoxSums> replicates) const {
  Estimate most;
  for (std::size_t ring = 0; ring < rings_; ++ring) {
    const auto cosine = [&](std::size_t k) {
      return std::cos(radians(beyond_deg_ +
                              (180.0 - beyond_deg_) * static_cast<double>(k) / static_cast<double>(rings_)));
    };
    const double sr =
        (cosine(ring) - cosine(ring + 1)) * 2.0 * std::numbers::pi / static_cast<double>(kGlareSectors);
    for (std::size_t sector = 0; sector < kGlareSectors; ++sector) {
      const std::size_t cell = ring * kGlareSectors + sector;
      const Estimate e = replicate_share(replicates, [&](const BoxSums& r) { return r.glare[cell] / sr; });
      if (e.mean > most.mean) most = e;
    }
  }
  return most;
}

}  // namespace lucerna
