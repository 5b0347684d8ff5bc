// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/binning/binned_intensity.h"
#include "lucerna/photometry/comparison/transport.h"
#include "lucerna/photometry/data/resample.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

constexpr std::size_t kTransportMasses = 600;

/// Both distributions on the union of their grids.
struct Common {
  std::vector<Direction> directions;
  std::vector<double> weight_sr, a, b;
};

std::vector<double> union_of(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end());
  std::vector<double> result;
  for (const double angle : all) {
    if (result.empty() || angle - result.back() > 1e-6) result.push_back(angle);
  }
  return result;
}

/// Planes of both; a rotational grid alone would not resolve a tilt, so there are at least 24.
std::vector<double> union_planes(const IntensityDistribution& a, const IntensityDistribution& b) {
  std::vector<double> planes = union_of(a.c_deg, b.c_deg);
  if (planes.size() >= 24) return planes;
  std::vector<double> regular;
  for (int c = 0; c < 24; ++c) regular.push_back(15.0 * c);
  return union_of(planes, regular);
}

/// The whole sphere: just beyond a grid that ends with light there is a dark ring.
std::vector<double> union_gammas(const IntensityDistribution& a, const IntensityDistribution& b) {
  std::vector<double> gammas = union_of(a.gamma_deg, b.gamma_deg);
  if (gammas.front() > 0.0) gammas.insert(gammas.begin(), 0.0);
  if (gammas.back() < 180.0) gammas.push_back(180.0);
  return gammas;
}

Common common_grid(const IntensityDistribution& a, const IntensityDistribution& b) {
  const std::vector<double> planes = union_planes(a, b), gammas = union_gammas(a, b);
  // The cells of both grids' own rings: a ring next to the dark must not take half of the dark as its cell.
  Common common;
  common.weight_sr = intensity_bins(planes, gammas).solid_angle_sr;
  const double last = std::max(a.gamma_deg.back(), b.gamma_deg.back());
  const double first = std::min(a.gamma_deg.front(), b.gamma_deg.front());
  for (const double c : planes) {
    for (const double g : gammas) {
      common.directions.push_back(direction_from_type_c({radians(c), radians(g)}));
      common.a.push_back(intensity_at(a, c, g));
      common.b.push_back(intensity_at(b, c, g));
    }
  }
  const std::vector<double> bounded = union_of(a.gamma_deg, b.gamma_deg);
  const std::vector<double> inner = intensity_bins(planes, bounded).solid_angle_sr;
  for (std::size_t c = 0, i = 0; c < planes.size(); ++c) {
    std::size_t k = c * bounded.size();
    for (const double g : gammas) {
      if (g >= first && g <= last) common.weight_sr[i] = inner[k++];
      ++i;
    }
  }
  return common;
}

struct CommonSums {
  double difference = 0.0, reference = 0.0, both = 0.0;
  double rms() const { return std::sqrt(difference / reference); }
};

CommonSums sums_of(const Common& common, bool weighted) {
  CommonSums sums;
  for (std::size_t i = 0; i < common.a.size(); ++i) {
    const double w = weighted ? common.weight_sr[i] : 1.0, d = common.a[i] - common.b[i],
                 s = common.a[i] + common.b[i];
    sums.difference += w * d * d;
    sums.reference += w * common.a[i] * common.a[i];
    sums.both += w * s * s;
  }
  return sums;
}

/// Shares of the unit flux per cell.
std::vector<double> shares(const std::vector<double>& cd, const std::vector<double>& weight) {
  std::vector<double> share(cd.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < cd.size(); ++i) sum += share[i] = cd[i] * weight[i];
  for (double& each : share) each /= sum;
  return share;
}

/// Wasserstein-1 with a metric cost depends on the difference only: what both have in one place stays there.
double wasserstein_of(const Common& common, const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<DirectionMass> surplus, want;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = a[i] - b[i];
    if (d > 1e-15) surplus.push_back({common.directions[i], d});
    if (d < -1e-15) want.push_back({common.directions[i], -d});
  }
  return degrees(transport_cost_rad(clustered(std::move(surplus), kTransportMasses),
                                    clustered(std::move(want), kTransportMasses)));
}

double noise_floor_of(const IntensityDistribution& d, std::span<const double> error, const Common& common) {
  if (error.empty()) return 0.0;
  if (error.size() != d.cd.size())
    throw InputError(fmt::format("{} standard errors for {} values", error.size(), d.cd.size()));
  IntensityDistribution variance = d;
  for (std::size_t i = 0; i < error.size(); ++i) variance.cd[i] = error[i] * error[i];
  double sum = 0.0;
  for (std::size_t i = 0; i < common.a.size(); ++i)
    sum += common.weight_sr[i] * intensity_in(variance, common.directions[i]);
  return sum;
}

/// Relative RMS with the test turned by `rotation` (rad).
double rotated_rms(const Common& common, const IntensityDistribution& test, const Vec3& rotation) {
  double difference = 0.0, reference = 0.0;
  for (std::size_t i = 0; i < common.a.size(); ++i) {
    const double d = common.a[i] - intensity_in(test, rotated_by(common.directions[i], -rotation));
    difference += common.weight_sr[i] * d * d;
    reference += common.weight_sr[i] * common.a[i] * common.a[i];
  }
  return std::sqrt(difference / reference);
}

/// Nelder and Mead's simplex (1965) for three parameters, `start` with edges of `size`; never worse than it.
template <class F>
Vec3 minimise(F&& f, const Vec3& start, double size, int evaluations) {
  std::array<std::pair<double, Vec3>, 4> simplex;
  const Vec3 edges[] = {{}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  for (std::size_t i = 0; i < 4; ++i) simplex[i] = {f(start + edges[i]), start + edges[i]};
  const auto sort = [&] {
    std::sort(simplex.begin(), simplex.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  };
  for (int used = 4; used < evaluations; ++used) {
    sort();
    if (length(simplex[3].second - simplex[0].second) < 1e-6) break;
    const Vec3 centre = (simplex[0].second + simplex[1].second + simplex[2].second) / 3.0;
    const auto cost_at = [&](double t) {
      const Vec3 x = centre + t * (simplex[3].second - centre);
      return std::pair{f(x), x};
    };
    const auto reflected = cost_at(-1.0);
    if (reflected.first < simplex[0].first) {
      const auto further = cost_at(-2.0);
      simplex[3] = further.first < reflected.first ? further : reflected;
    } else if (reflected.first < simplex[2].first) {
      simplex[3] = reflected;
    } else if (const auto inside = cost_at(0.5); inside.first < simplex[3].first) {
      simplex[3] = inside;
    } else {
      for (std::size_t i = 1; i < 4; ++i) {
        const Vec3 x = 0.5 * (simplex[0].second + simplex[i].second);
        simplex[i] = {f(x), x};
      }
    }
  }
  sort();
  return simplex[0].second;
}

/// Cells that a rotation is looked for with.
constexpr std::size_t kAlignedCells = 12000;

/// Only cells that matter: those that hold the reference's or the test's light, at most `limit` of them.
Common thinned(const Common& common, std::size_t limit) {
  if (common.a.size() <= limit) return common;
  Common result;
  const std::size_t stride = (common.a.size() + limit - 1) / limit;
  for (std::size_t i = 0; i < common.a.size(); i += stride) {
    result.directions.push_back(common.directions[i]);
    result.weight_sr.push_back(common.weight_sr[i]);
    result.a.push_back(common.a[i]);
    result.b.push_back(common.b[i]);
  }
  return result;
}

/// How a rotation is looked for: a first step, and so many evaluations at most.
struct Search {
  double step_deg;
  int evaluations;
};
/// Of distributions as they are given; and near where that ended, of copies of them with other noise.
constexpr Search kWholeSearch{2.0, 160}, kNearSearch{0.5, 60};

/// The rotation that fits best from `start` on, and what it leaves of `common`: no rotation where none helps.
struct Turn {
  Vec3 rotation;
  double rms = 0.0;
};

Turn best_turn(const Common& common, const IntensityDistribution& test, const Vec3& start,
               const Search& search) {
  const Common few = thinned(common, kAlignedCells);
  const Vec3 rotation = minimise([&](const Vec3& r) { return rotated_rms(few, test, r); }, start,
                                 radians(search.step_deg), search.evaluations);
  const double last = rotated_rms(common, test, rotation), none = rotated_rms(common, test, {});
  return none <= last ? Turn{{}, none} : Turn{rotation, last};
}

/// Where a search begins: the two conventions for C0 differ by a quarter turn.
Vec3 best_quarter_turn(const Common& common, const IntensityDistribution& test) {
  const Common few = thinned(common, kAlignedCells);
  Vec3 start;
  double best = rotated_rms(few, test, start);
  for (const double turn : {90.0, 180.0, -90.0}) {
    const Vec3 rotation{0.0, 0.0, radians(turn)};
    const double rms = rotated_rms(few, test, rotation);
    if (rms < 0.98 * best) {
      best = rms;
      start = rotation;
    }
  }
  return start;
}

void check_comparable(const IntensityDistribution& reference, const IntensityDistribution& test) {
  for (const auto& [name, d] : {std::pair{"reference", &reference}, std::pair{"test", &test}}) {
    if (const std::string fault = grid_fault(*d); !fault.empty())
      throw InputError(fmt::format("{}: {}", name, fault));
    if (!(peak_intensity(*d).cd > 0.0)) throw InputError(fmt::format("{}: no light to compare", name));
  }
  if (reference.unit != test.unit) throw InputError("one distribution is in cd, the other in W/sr");
}

}  // namespace

double wasserstein_deg(const IntensityDistribution& a, const IntensityDistribution& b) {
  check_comparable(a, b);
  const Common common = common_grid(a, b);
  return wasserstein_of(common, shares(common.a, common.weight_sr), shares(common.b, common.weight_sr));
}

namespace {

/// Copies of which the scatter is taken.
constexpr std::size_t kCopies = 8;

/// The figures of one pair of distributions, without errors.
struct Figures {
  double relative_rms, bergen_fit, bergen_fit_unweighted, flux_ratio, peak_ratio, wasserstein_deg, overlap;
};

Figures figures_of(const Common& common, const IntensityDistribution& reference,
                   const IntensityDistribution& test) {
  const CommonSums weighted = sums_of(common, true), plain = sums_of(common, false);
  const std::vector<double> a = shares(common.a, common.weight_sr), b = shares(common.b, common.weight_sr);
  double apart = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) apart += std::abs(a[i] - b[i]);
  return {weighted.rms(),
          100.0 * (1.0 - std::sqrt(weighted.difference / weighted.both)),
          100.0 * (1.0 - std::sqrt(plain.difference / plain.both)),
          total_flux(test) / total_flux(reference),
          peak_intensity(test).cd / peak_intensity(reference).cd,
          wasserstein_of(common, a, b),
          1.0 - 0.5 * apart};
}

/// Evenly distributed, of mean 0 and standard deviation 1.
double even(std::uint64_t seed, std::size_t i) {
  return std::sqrt(3.0) * (2.0 * Rng(seed, i).uniform() - 1.0);
}

/// The values moved by their errors at random; none below 0. All together then meet a flux that is moved by
/// its own error, where that is known.
IntensityDistribution moved(const IntensityDistribution& d, std::span<const double> error,
                            const std::optional<double>& flux_error, std::uint64_t seed) {
  IntensityDistribution out = d;
  for (std::size_t i = 0; i < error.size(); ++i)
    out.cd[i] = std::max(0.0, out.cd[i] + even(seed, i) * error[i]);
  if (flux_error && !error.empty())
    scale(out, (total_flux(d) + even(seed, error.size()) * *flux_error) / total_flux(out));
  return out;
}

/// What noise makes of a comparison: copies of it with moved values; none where no errors were given.
struct Copies {
  std::vector<Figures> figures;
  std::vector<Turn> turns;
};

Copies moved_copies(const IntensityDistribution& reference, const IntensityDistribution& test,
                    const CompareOptions& options, const std::optional<Turn>& turn) {
  Copies copies;
  if (options.reference_error_cd.empty() && options.test_error_cd.empty()) return copies;
  copies.figures.resize(kCopies);
  if (turn) copies.turns.resize(kCopies);
  parallel_blocks(kCopies, 1, [&](std::size_t k, std::size_t) {
    const IntensityDistribution a = moved(reference, options.reference_error_cd, options.reference_flux_error,
                                          2 * k + 1),
                                b = moved(test, options.test_error_cd, options.test_flux_error, 2 * k + 2);
    const Common common = common_grid(a, b);
    copies.figures[k] = figures_of(common, a, b);
    if (turn) copies.turns[k] = best_turn(common, b, turn->rotation, kNearSearch);
  });
  return copies;
}

/// Scatter of `figure(copy)`; NaN where there are no copies.
template <class Copy, class Figure>
double scatter(const std::vector<Copy>& copies, const Figure& figure) {
  if (copies.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(copies.size());
  double mean = 0.0, squares = 0.0;
  for (const Copy& c : copies) mean += figure(c) / n;
  for (const Copy& c : copies) squares += (figure(c) - mean) * (figure(c) - mean);
  return std::sqrt(squares / (n - 1.0));
}

/// Where nadir turns to.
TypeCAngles nadir_after(const Turn& turn) {
  return type_c_angles(rotated_by(Direction::from_unit({0.0, 0.0, -1.0}), turn.rotation));
}

/// Directions about the vertical that a turn is compared with.
constexpr int kOtherTurns = 24;
/// Standard deviation of a turn that may be any, degrees.
const double kAnyTurn_deg = 360.0 / std::sqrt(12.0);

/// Whether other turns about the vertical fit as well, but for the noise of a squared difference.
bool fits_any_turn(const Common& common, const IntensityDistribution& test, const Turn& found,
                   double square_error) {
  const Common few = thinned(common, kAlignedCells);
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (int k = 0; k < kOtherTurns; ++k) {
    const Vec3 other = found.rotation + Vec3{0.0, 0.0, 2.0 * std::numbers::pi * k / kOtherTurns};
    const double rms = rotated_rms(few, test, other);
    least = std::min(least, rms);
    most = std::max(most, rms);
  }
  return most * most - least * least <= std::max(3.0 * square_error, 1e-4 * most * most);
}

Alignment alignment_of(const Turn& found, const std::vector<Turn>& copies) {
  const TypeCAngles to = nadir_after(found);
  Alignment result;
  result.tilt_deg = {degrees(to.gamma_rad),
                     scatter(copies, [](const Turn& t) { return degrees(nadir_after(t).gamma_rad); })};
  result.tilt_toward_c_deg = {
      to.gamma_rad > 0.0 ? degrees(to.c_rad) : 0.0, scatter(copies, [&](const Turn& t) {
        return degrees(std::remainder(nadir_after(t).c_rad - to.c_rad, 2.0 * std::numbers::pi));
      })};
  result.turn_deg = {degrees(found.rotation.z),
                     scatter(copies, [](const Turn& t) { return degrees(t.rotation.z); })};
  result.relative_rms = {found.rms, scatter(copies, [](const Turn& t) { return t.rms; })};
  return result;
}

/// The noise of a root: sigma / (2 root) of its square's where that is far from 0, sqrt(sigma) at 0.
Estimate root_of(double square, double square_error) {
  const double root = std::sqrt(std::max(0.0, square));
  if (square_error == 0.0) return {root, 0.0};
  return {root, square_error / std::sqrt(4.0 * root * root + square_error)};
}

}  // namespace

DistributionComparison compare_distributions(const IntensityDistribution& reference,
                                             const IntensityDistribution& test,
                                             const CompareOptions& options) {
  check_comparable(reference, test);
  const Common common = common_grid(reference, test);
  const double signal = sums_of(common, true).reference;
  const double noise = noise_floor_of(reference, options.reference_error_cd, common) +
                       noise_floor_of(test, options.test_error_cd, common);
  const Figures f = figures_of(common, reference, test);
  std::optional<Turn> turn;
  if (options.align) turn = best_turn(common, test, best_quarter_turn(common, test), kWholeSearch);
  const Copies copies = moved_copies(reference, test, options, turn);
  const auto with_error = [&](double Figures::*figure) {
    return Estimate{f.*figure, scatter(copies.figures, [&](const Figures& c) { return c.*figure; })};
  };
  DistributionComparison result;
  result.relative_rms = with_error(&Figures::relative_rms);
  result.bergen_fit = with_error(&Figures::bergen_fit);
  result.bergen_fit_unweighted = with_error(&Figures::bergen_fit_unweighted);
  result.flux_ratio = with_error(&Figures::flux_ratio);
  result.peak_ratio = with_error(&Figures::peak_ratio);
  result.wasserstein_deg = with_error(&Figures::wasserstein_deg);
  result.overlap = with_error(&Figures::overlap);
  result.noise_floor = std::sqrt(noise / signal);
  const double square_error =
      scatter(copies.figures, [](const Figures& c) { return c.relative_rms * c.relative_rms; });
  result.excess = root_of(f.relative_rms * f.relative_rms - noise / signal, square_error);
  if (turn) {
    result.alignment = alignment_of(*turn, copies.turns);
    if (fits_any_turn(common, test, *turn, std::isfinite(square_error) ? square_error : 0.0))
      result.alignment->turn_deg = {0.0, kAnyTurn_deg};
  }
  return result;
}

}  // namespace lucerna
