// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/expand_grid.h"

#include <algorithm>
#include <cmath>

#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

constexpr double kSpread = 1e-3;  // photometric-formats 1.4: warn above 0.1 %

bool same(double a, double b) { return std::abs(a - b) <= kEqualAngle_deg; }

void check_ascending(const std::vector<double>& angles, std::size_t line, const char* what,
                     const RepairLog& log) {
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (!(angles[i] > angles[i - 1])) {
      log.fail(line, "{} angles do not ascend: {} after {}", what, angles[i], angles[i - 1]);
    }
  }
}

void clamp_negative(ListedGrid& grid, RepairLog& log) {
  std::size_t count = 0;
  double lowest = 0.0;
  for (double& value : grid.cd) {
    if (value >= 0.0) continue;
    lowest = std::min(lowest, value);
    value = 0.0;
    ++count;
  }
  if (count > 0)
    log.repair(grid.values_line, "{} negative intensities (lowest {:g} cd) set to 0", count, lowest);
}

/// Puts a ring before index `at` (0 or the end): a copy of the neighbouring ring, or dark.
void add_ring(ListedGrid& grid, bool at_end, double gamma, bool dark) {
  const std::size_t n = grid.gammas_deg.size();
  std::vector<double> cd;
  for (std::size_t c = 0; c < grid.planes_deg.size(); ++c) {
    const auto row = grid.cd.begin() + static_cast<std::ptrdiff_t>(c * n);
    const double value = dark ? 0.0 : at_end ? row[static_cast<std::ptrdiff_t>(n) - 1] : row[0];
    if (!at_end) cd.push_back(value);
    cd.insert(cd.end(), row, row + static_cast<std::ptrdiff_t>(n));
    if (at_end) cd.push_back(value);
  }
  grid.cd = std::move(cd);
  grid.gammas_deg.insert(at_end ? grid.gammas_deg.end() : grid.gammas_deg.begin(), gamma);
}

void complete_gammas(ListedGrid& grid, RepairLog& log) {
  check_ascending(grid.gammas_deg, grid.gammas_line, "vertical", log);
  for (double& g : grid.gammas_deg) {
    for (const double exact : {0.0, 90.0, 180.0}) {
      if (same(g, exact)) g = exact;
    }
  }
  const double first = grid.gammas_deg.front(), last = grid.gammas_deg.back();
  if (first < 0.0 || last > 180.0)
    log.fail(grid.gammas_line, "vertical angles {} to {} found, 0 to 180 expected", first, last);
  if (first != 0.0 && first != 90.0) {
    const bool upper = first > 90.0;
    log.repair(grid.gammas_line, "vertical angles start at {}, {} expected: {}", first, upper ? 90 : 0,
               upper ? "a dark ring added" : "the first ring repeated");
    add_ring(grid, false, upper ? 90.0 : 0.0, upper);
  }
  if (last != 90.0 && last != 180.0) {
    const double end = last < 90.0 ? 90.0 : 180.0;
    log.repair(grid.gammas_line, "vertical angles end at {}, {} expected: a dark ring added", last, end);
    add_ring(grid, true, end, true);
  }
}

struct Span {
  double from, to;
};

Span span_of(ListedSymmetry symmetry) {
  switch (symmetry) {
    case ListedSymmetry::half_0_180:
      return {0.0, 180.0};
    case ListedSymmetry::half_90_270:
      return {90.0, 270.0};
    case ListedSymmetry::half_270_90:
      return {270.0, 450.0};
    case ListedSymmetry::quarter:
      return {0.0, 90.0};
    case ListedSymmetry::rotational:
    case ListedSymmetry::full:
      break;
  }
  return {0.0, 360.0};
}

/// One plane of the result and the stored planes that it is the mean of.
struct Plane {
  double c_deg;
  std::size_t first, second;
};

void add_plane(std::vector<Plane>& planes, double c_deg, std::size_t stored) {
  double c = std::fmod(c_deg, 360.0);
  if (c < 0.0) c += 360.0;
  if (360.0 - c <= kEqualAngle_deg || c <= kEqualAngle_deg) c = 0.0;
  for (Plane& plane : planes) {
    if (same(plane.c_deg, c)) {
      plane.second = stored;
      return;
    }
  }
  planes.push_back({c, stored, stored});
}

std::vector<Plane> mirrored_planes(const ListedGrid& grid, ListedSymmetry symmetry, const RepairLog& log) {
  const auto& h = grid.planes_deg;
  if (symmetry == ListedSymmetry::rotational) return {{0.0, 0, 0}};
  const Span span = span_of(symmetry);
  if (symmetry != ListedSymmetry::full && (!same(h.front(), span.from) || !same(h.back(), span.to))) {
    log.fail(grid.planes_line, "planes {} to {} found, {} to {} expected", h.front(), h.back(), span.from,
             span.to);
  }
  if (!same(h.front(), span.from) || h.back() > span.to + kEqualAngle_deg) {
    log.fail(grid.planes_line, "planes {} to {} found, {} to at most {} expected", h.front(), h.back(),
             span.from, span.to);
  }
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < h.size(); ++i) add_plane(planes, h[i], i);
  if (symmetry == ListedSymmetry::full) return planes;
  // A plane on its own mirror plane is met again as itself: `add_plane` then changes nothing.
  const auto add_mirror = [&](double about) {
    for (std::size_t i = 0; i < h.size(); ++i) add_plane(planes, about - h[i], i);
  };
  if (symmetry == ListedSymmetry::half_0_180) add_mirror(360.0);
  if (symmetry == ListedSymmetry::half_90_270 || symmetry == ListedSymmetry::half_270_90) add_mirror(180.0);
  if (symmetry == ListedSymmetry::quarter) {
    add_mirror(180.0);
    add_mirror(360.0);
    for (std::size_t i = 0; i < h.size(); ++i) add_plane(planes, 180.0 + h[i], i);
  }
  return planes;
}

/// A grid begins with C0: where no plane is stored there, it lies between its neighbours as everywhere.
void add_plane_at_0(IntensityDistribution& d) {
  const std::size_t last = d.c_deg.size() - 1, gammas = d.gamma_deg.size();
  const double before = 360.0 - d.c_deg.back(), after = d.c_deg.front();
  std::vector<double> row(gammas);
  for (std::size_t g = 0; g < gammas; ++g)
    row[g] = (after * d.at(last, g) + before * d.at(0, g)) / (before + after);
  d.c_deg.insert(d.c_deg.begin(), 0.0);
  d.cd.insert(d.cd.begin(), row.begin(), row.end());
}

/// All planes meet at a pole: the mean for all, so that nothing depends on the plane a ray is nearest to.
double even_out_row(IntensityDistribution& d, std::size_t g) {
  const std::vector<double> weights = plane_weights(d.c_deg);
  double mean = 0.0, lowest = d.at(0, g), highest = lowest;
  for (std::size_t c = 0; c < weights.size(); ++c) {
    const double value = d.at(c, g);
    mean += weights[c] * value;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (lowest == highest) return 0.0;
  for (std::size_t c = 0; c < weights.size(); ++c) d.at(c, g) = mean;
  return (highest - lowest) / mean;
}

}  // namespace

IntensityDistribution expanded(ListedGrid grid, ListedSymmetry symmetry, RepairLog& log,
                               double& nadir_spread) {
  clamp_negative(grid, log);
  complete_gammas(grid, log);
  check_ascending(grid.planes_deg, grid.planes_line, "horizontal", log);
  std::vector<Plane> planes = mirrored_planes(grid, symmetry, log);
  std::sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.c_deg < b.c_deg; });
  const std::size_t gammas = grid.gammas_deg.size();
  const double peak = *std::max_element(grid.cd.begin(), grid.cd.end());
  IntensityDistribution d;
  d.gamma_deg = grid.gammas_deg;
  d.cd.reserve(planes.size() * gammas);
  for (const Plane& plane : planes) {
    d.c_deg.push_back(plane.c_deg);
    double worst = 0.0;
    for (std::size_t g = 0; g < gammas; ++g) {
      const double a = grid.cd[plane.first * gammas + g], b = grid.cd[plane.second * gammas + g];
      d.cd.push_back(a == b ? a : 0.5 * (a + b));
      worst = std::max(worst, std::abs(a - b));
    }
    if (worst > kSpread * peak) {
      log.repair(grid.planes_line, "the planes at {} and {} differ by up to {:g} cd: mean taken", plane.c_deg,
                 plane.c_deg + 360.0, worst);
    }
  }
  if (d.c_deg.front() > 0.0) add_plane_at_0(d);
  nadir_spread = d.gamma_deg.front() == 0.0 ? even_out_row(d, 0) : 0.0;
  const double zenith_spread = d.gamma_deg.back() == 180.0 ? even_out_row(d, gammas - 1) : 0.0;
  for (const auto& [name, spread] : {std::pair{"nadir", nadir_spread}, std::pair{"zenith", zenith_spread}}) {
    if (spread > kSpread) {
      log.repair(grid.values_line, "intensity at the {} differs between planes by {:.2f} %: mean taken", name,
                 100.0 * spread);
    }
  }
  return d;
}

}  // namespace lucerna
