// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/box_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Replicates that carry the stated errors of a table.
constexpr std::size_t kTableReplicates = 16;

/// Shares of the flux in some cells, by replicate, beside the target.
struct Cells {
  std::vector<double> measure, target;
  std::vector<std::vector<double>> share;

  /// The target's squared norm.
  double norm2() const {
    double sum = 0.0;
    for (std::size_t b = 0; b < target.size(); ++b) sum += target[b] * target[b] / measure[b];
    return sum;
  }
  void add(double cell_measure, double cell_target, const std::vector<double>& shares) {
    if (cell_measure == 0.0) return;
    measure.push_back(cell_measure);
    target.push_back(cell_target);
    for (std::size_t r = 0; r < shares.size(); ++r) share[r].push_back(shares[r]);
  }
};

/// The rectangle in n x n boxes; n divides 48.
Cells inside(const ErrorBoxes& boxes, std::span<const double> target, std::span<const BoxSums> replicates,
             int n) {
  Cells cells;
  cells.share.resize(replicates.size());
  const int m = kErrorBoxes / n;
  std::vector<double> shares(replicates.size());
  for (int v = 0; v < kErrorBoxes; v += m) {
    for (int u = 0; u < kErrorBoxes; u += m) {
      double measure = 0.0, expected = 0.0;
      std::fill(shares.begin(), shares.end(), 0.0);
      for (int k = 0; k < m * m; ++k) {
        const auto b = static_cast<std::size_t>((v + k / m) * kErrorBoxes + u + k % m);
        if (boxes.measure()[b] == 0.0) continue;
        measure += boxes.measure()[b];
        expected += target[b];
        for (std::size_t r = 0; r < shares.size(); ++r) {
          shares[r] += replicates[r].flux[b] / replicates[r].emitted;
        }
      }
      cells.add(measure, expected, shares);
    }
  }
  return cells;
}

Cells outside(const ErrorBoxes& boxes, std::span<const double> target, std::span<const BoxSums> replicates) {
  Cells cells;
  cells.share.resize(replicates.size());
  std::vector<double> shares(replicates.size());
  for (std::size_t b = ErrorBoxes::kInside; b < boxes.size(); ++b) {
    for (std::size_t r = 0; r < shares.size(); ++r) {
      shares[r] = replicates[r].flux[b] / replicates[r].emitted;
    }
    cells.add(boxes.measure()[b], target[b], shares);
  }
  return cells;
}

/// The shares of a cell over the replicates.
Estimate share_of(const Cells& cells, std::size_t b) {
  std::vector<double> shares;
  for (const auto& share : cells.share) shares.push_back(share[b]);
  return mean_estimate(shares);
}

/// The scale that makes the excess smallest: that of the least squares, less what noise adds to |f|^2.
double best_scale(const Cells& cells) {
  double ft = 0.0, ff = 0.0, noise = 0.0;
  for (std::size_t b = 0; b < cells.target.size(); ++b) {
    const Estimate f = share_of(cells, b);
    ft += f.mean * cells.target[b] / cells.measure[b];
    ff += f.mean * f.mean / cells.measure[b];
    if (cells.share.size() > 1) noise += f.standard_error * f.standard_error / cells.measure[b];
  }
  if (!(ff > 0.0)) return 0.0;
  return ft / std::max(ff - noise, 0.1 * ff);
}

/// Relative residuals: their mean over the replicates, and each replicate's deviation from it.
struct Residuals {
  std::vector<double> mean;
  std::vector<std::vector<double>> off;
};

Residuals residuals(const Cells& cells, double scale, double norm2) {
  const std::size_t n = cells.target.size(), replicates = cells.share.size();
  Residuals out{std::vector<double>(n, 0.0), {}};
  for (std::size_t r = 0; r < replicates; ++r) {
    std::vector<double>& x = out.off.emplace_back(n);
    for (std::size_t b = 0; b < n; ++b) {
      x[b] = (scale * cells.share[r][b] - cells.target[b]) / std::sqrt(cells.measure[b] * norm2);
      out.mean[b] += x[b] / static_cast<double>(replicates);
    }
  }
  for (auto& x : out.off) {
    for (std::size_t b = 0; b < n; ++b) x[b] -= out.mean[b];
  }
  return out;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Mean squared scatter of the products of different replicates' deviations: trace(Sigma^2) of the covariance
/// Sigma of one replicate.
double trace_of_square(const Residuals& x) {
  std::vector<double> products;
  for (std::size_t r = 0; r < x.off.size(); ++r) {
    for (std::size_t s = 0; s < r; ++s) products.push_back(product(x.off[r], x.off[s]));
  }
  const double mean = mean_estimate(products).mean;
  double square = 0.0;
  for (const double p : products) square += (p - mean) * (p - mean);
  return square / static_cast<double>(products.size());
}

/// The estimate from residuals. E = value^2 - floor^2 has no bias; with the residuals' true mean m its
/// variance is 4 m' Sigma m / R + 2 trace(Sigma^2) / R^2.
BoxErrorEstimate estimate(const Residuals& x) {
  const auto n = static_cast<double>(x.off.size());
  BoxErrorEstimate out;
  const double square = product(x.mean, x.mean);
  out.value = out.excess = std::sqrt(square);
  out.standard_error = std::numeric_limits<double>::quiet_NaN();
  if (x.off.size() < 2) return out;
  double noise = 0.0, along = 0.0;
  for (const auto& off : x.off) {
    noise += product(off, off) / (n * (n - 1.0));
    const double p = product(x.mean, off);
    along += p * p / (n * (n - 1.0));
  }
  const double pairs = 2.0 * trace_of_square(x) / (n * n);
  // `along` has the noise of the mean in it: m' Sigma m / R + trace(Sigma^2) / R^2.
  const double sigma = std::sqrt(std::max(pairs, 4.0 * along - pairs));
  const double excess2 = std::max(0.0, square - noise);
  out.floor = std::sqrt(noise);
  out.excess = std::sqrt(excess2);
  // Of the root: sigma / (2 excess) where the excess is large, sqrt(sigma) where it is 0.
  out.standard_error = sigma > 0.0 ? sigma / std::sqrt(4.0 * excess2 + sigma) : 0.0;
  return out;
}

/// The largest deviation of a box.
Estimate worst_cell(const Cells& cells, double scale) {
  double peak = 0.0;
  Estimate worst;
  for (std::size_t b = 0; b < cells.target.size(); ++b) {
    peak = std::max(peak, cells.target[b] / cells.measure[b]);
    const Estimate f = share_of(cells, b);
    const double off = std::abs(scale * f.mean - cells.target[b]) / cells.measure[b];
    if (off >= worst.mean) worst = {off, scale * f.standard_error / cells.measure[b]};
  }
  return {worst.mean / peak, worst.standard_error / peak};
}

/// Deviations of a table's values within their stated errors, by replicate: independent and normal, summing
/// to 0 over the replicates, such that the scatter of the replicates' mean is that of the table.
std::vector<IntensityDistribution> deviations(const KnownDistribution& table, std::uint64_t seed) {
  std::vector<IntensityDistribution> out(kTableReplicates, table.distribution);
  for (std::size_t i = 0; i < table.standard_error_cd.size(); ++i) {
    Rng rng(seed, i);
    std::array<double, kTableReplicates> z{};
    double mean = 0.0;
    for (double& x : z) {
      const double radius = std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
      x = radius * std::cos(2.0 * std::numbers::pi * rng.uniform());
      mean += x / kTableReplicates;
    }
    // The mean of R replicates has the variance of one over R.
    const double sigma = table.standard_error_cd[i] * std::sqrt(static_cast<double>(kTableReplicates));
    for (std::size_t r = 0; r < out.size(); ++r) out[r].cd[i] = sigma * (z[r] - mean);
  }
  return out;
}

/// Adds the scatter of a table's stated errors, times `factor`, to replicates (one for all so far, or all).
void add_scatter(const ErrorBoxes& boxes, const KnownDistribution& table, double factor, std::uint64_t seed,
                 std::vector<BoxSums>& sums) {
  if (table.standard_error_cd.empty()) return;
  if (sums.size() == 1) sums.resize(kTableReplicates, sums.front());
  constexpr double kCoarse_rad = 10.0;  // few points a box: noise need not be integrated to many digits
  const std::vector<IntensityDistribution> all = deviations(table, seed);
  for (std::size_t r = 0; r < all.size(); ++r) {
    const auto flux = boxes.flux_of([&](const Direction& d) { return intensity_in(all[r], d); }, kCoarse_rad);
    for (std::size_t c = 0; c < flux.size(); ++c) sums[r].flux[c] += factor * flux[c];
  }
}

/// An exact table as one replicate.
BoxSums table_sums(const ErrorBoxes& boxes, const IntensityDistribution& table) {
  BoxSums exact;
  exact.flux = boxes.flux_of(table);
  exact.emitted = exact.out_reflected = std::accumulate(exact.flux.begin(), exact.flux.end(), 0.0);
  exact.rays = 1;
  return exact;
}

void check_table(const KnownDistribution& table, const char* name) {
  const std::size_t values = table.distribution.cd.size(), errors = table.standard_error_cd.size();
  if (const std::string fault = grid_fault(table.distribution); !fault.empty())
    throw InputError(fmt::format("{}: {}", name, fault));
  if (errors != 0 && errors != values)
    throw InputError(fmt::format("{}: {} standard errors for {} values", name, errors, values));
}

void add_cells(const std::vector<double>& cells, std::vector<double>& to) {
  if (to.empty()) to.assign(cells.size(), 0.0);
  LUCERNA_CHECK(to.size() == cells.size(), "{} cells and {}", to.size(), cells.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += cells[i];
}

/// What a part leaves of a flux. Sums in different orders leave rounding, which is no light.
double rest_of(double whole, double part) {
  constexpr double kRounding = 1e-11;
  return std::abs(whole - part) > kRounding * whole ? whole - part : 0.0;
}

}  // namespace

BoxSums& BoxSums::operator+=(const BoxSums& other) {
  add_cells(other.flux, flux);
  add_cells(other.direct, direct);
  add_cells(other.zones, zones);
  add_cells(other.zones_direct, zones_direct);
  add_cells(other.glare, glare);
  add_cells(other.glare_direct, glare_direct);
  emitted += other.emitted;
  out_direct += other.out_direct;
  out_reflected += other.out_reflected;
  absorbed += other.absorbed;
  back += other.back;
  bodies += other.bodies;
  lost += other.lost;
  rays += other.rays;
  return *this;
}

double flux_inside(std::span<const double> cells) {
  const std::size_t count = std::min<std::size_t>(cells.size(), ErrorBoxes::kInside);
  return std::accumulate(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(count), 0.0);
}

std::vector<double> box_target(const ErrorBoxes& boxes, const DesignTarget& target, double source_flux) {
  std::vector<double> flux;
  if (target.plane) {
    const PlaneTarget& p = *target.plane;
    const double step =
        std::min(p.size_x_mm / static_cast<double>(p.map.nx), p.size_y_mm / static_cast<double>(p.map.ny));
    flux = boxes.flux_on([&](double x, double y) { return p.at(x, y) / kMm2PerM2; }, step);
  } else {
    flux = boxes.flux_of(target.distribution);
  }
  if (!(flux_inside(flux) > 0.0)) throw InputError("target: has no light in its rectangle");
  if (target.mode == TargetMode::absolute) {
    for (double& f : flux) f /= source_flux;
  }
  return flux;
}

DesignError box_error(const ErrorBoxes& boxes, std::span<const double> target,
                      std::span<const BoxSums> replicates, TargetMode mode) {
  LUCERNA_CHECK(target.size() == boxes.size() && !replicates.empty(), "{} of {} cells, {} replicates",
                target.size(), boxes.size(), replicates.size());
  DesignError out;
  for (const BoxSums& r : replicates) {
    LUCERNA_CHECK(r.flux.size() == boxes.size() && r.emitted > 0.0, "a replicate of {} cells, flux {}",
                  r.flux.size(), r.emitted);
    out.rays += r.rays;
  }
  double norm2 = 0.0;
  for (const auto& [n, error] :
       {std::pair{12, &out.c12}, std::pair{24, &out.c24}, std::pair{kErrorBoxes, &out.c48}}) {
    const Cells cells = inside(boxes, target, replicates, n);
    out.scale = mode == TargetMode::shape ? best_scale(cells) : 1.0;
    norm2 = cells.norm2();
    *error = estimate(residuals(cells, out.scale, norm2));
    if (n == kErrorBoxes) out.worst_cell = worst_cell(cells, out.scale);
  }
  out.outside = estimate(residuals(outside(boxes, target, replicates), out.scale, norm2));
  out.in_rectangle = replicate_share(replicates, [](const BoxSums& r) { return flux_inside(r.flux); });
  out.outside_share = replicate_share(replicates, [](const BoxSums& r) {
    return rest_of(r.out_direct + r.out_reflected, flux_inside(r.flux));
  });
  out.outside_direct = replicate_share(
      replicates, [](const BoxSums& r) { return rest_of(r.out_direct, flux_inside(r.direct)); });
  return out;
}

DesignError box_error(const KnownDistribution& reference, const KnownDistribution& test, TargetMode mode) {
  check_table(reference, "reference");
  check_table(test, "test");
  if (mode == TargetMode::absolute && reference.distribution.unit != test.distribution.unit) {
    throw InputError("one distribution is in cd, the other in W/sr");
  }
  const ErrorBoxes boxes(target_rectangle(reference.distribution));
  std::vector<BoxSums> sums{table_sums(boxes, test.distribution)};
  if (!(sums.front().emitted > 0.0)) throw InputError("test: has no light");
  std::vector<double> target = boxes.flux_of(reference.distribution);
  if (mode == TargetMode::absolute) {
    for (double& t : target) t /= sums.front().emitted;
  }
  add_scatter(boxes, test, 1.0, 0x7ab1e, sums);
  DesignError out = box_error(boxes, target, sums, mode);
  if (reference.standard_error_cd.empty()) return out;
  // What the target may be off by, the light is off by from it. It says nothing of where the test's light is.
  const DesignError of_test = out;
  const double per_target = mode == TargetMode::shape ? sums.front().emitted / out.scale : 1.0;
  add_scatter(boxes, reference, -per_target, 0x7ab1f, sums);
  out = box_error(boxes, target, sums, mode);
  out.in_rectangle = of_test.in_rectangle;
  out.outside_share = of_test.outside_share;
  return out;
}

}  // namespace lucerna
