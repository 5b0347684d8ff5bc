// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

/// TM-15-11, addendum A, tables: the largest flux in lm for ratings 0 to 4.
using Limits = std::array<double, 5>;
constexpr Limits kBackLow{110, 500, 1000, 2500, 5000}, kBackMedium{220, 1000, 2500, 5000, 8500},
    kBackHigh{110, 500, 1000, 2500, 5000};
constexpr Limits kUp{0, 10, 50, 500, 1000};
constexpr Limits kVeryHigh{10, 100, 225, 500, 750}, kFrontHigh{660, 1800, 5000, 7500, 12000};

int rating(double flux_lm, const Limits& limits) {
  int number = 0;
  while (number < 5 && flux_lm > limits[static_cast<std::size_t>(number)]) ++number;
  return number;
}

void check_luminous(const IntensityDistribution& d, const char* what) {
  if (const std::string fault = grid_fault(d); !fault.empty())
    throw InputError(std::string(what) + ": " + fault);
  if (d.unit != FluxUnit::lumen)
    throw InputError(std::string(what) + ": the data are radiometric (W/sr); it is defined for lumens");
}

void check_threshold(double threshold, const char* what) {
  if (!(threshold >= 0.0))
    throw InputError(fmt::format("{}: threshold {}, 0 or more expected", what, threshold));
}

/// The rings' mean over the half circle from `from_deg` to `from_deg` + 180, halved: the rotational
/// distribution with the flux of that half. Linear in C between planes.
IntensityDistribution half_of(const IntensityDistribution& d, double from_deg) {
  std::vector<double> offsets{0.0, 180.0};
  for (const double c : d.c_deg) {
    double offset = std::fmod(c - from_deg, 360.0);
    if (offset < 0.0) offset += 360.0;
    if (offset > 0.0 && offset < 180.0) offsets.push_back(offset);
  }
  std::sort(offsets.begin(), offsets.end());
  IntensityDistribution half = zero_distribution({0.0}, d.gamma_deg, d.unit);
  for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      sum += 0.5 * (offsets[i + 1] - offsets[i]) *
             (intensity_at(d, from_deg + offsets[i], d.gamma_deg[g]) +
              intensity_at(d, from_deg + offsets[i + 1], d.gamma_deg[g]));
    }
    half.at(0, g) = sum / 360.0;
  }
  return half;
}

struct BugNumbers {
  int backlight = 0, uplight = 0, glare = 0;
  friend bool operator==(const BugNumbers&, const BugNumbers&) = default;
};

BugNumbers rate(const LuminaireZones& z, bool type_v, double dark_below_lm) {
  const auto lit = [&](double flux) { return flux <= dark_below_lm ? 0.0 : flux; };
  return {.backlight = std::max({rating(lit(z.back_low), kBackLow), rating(lit(z.back_medium), kBackMedium),
                                 rating(lit(z.back_high), kBackHigh)}),
          .uplight = std::max(rating(lit(z.up_low), kUp), rating(lit(z.up_high), kUp)),
          .glare = std::max({rating(lit(z.front_very_high), kVeryHigh),
                             rating(lit(z.back_very_high), kVeryHigh), rating(lit(z.front_high), kFrontHigh),
                             rating(lit(z.back_high), type_v ? kFrontHigh : kBackHigh)})};
}

/// Largest intensity at `from_deg` and above, or only above.
double largest_from(const IntensityDistribution& d, double from_deg, bool only_above) {
  double largest = 0.0;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    if (!only_above) largest = std::max(largest, intensity_at(d, d.c_deg[c], from_deg));
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      if (d.gamma_deg[g] > from_deg) largest = std::max(largest, d.at(c, g));
    }
  }
  return largest;
}

int class_number(const GlareClass& c, double dark_below) {
  struct Row {
    int number;
    double at_70, at_80, at_90;
    bool none_beyond_95;
  };
  constexpr double kAny = std::numeric_limits<double>::infinity();
  static constexpr Row kRows[] = {{6, 350, 100, 0, true},    {5, 350, 100, 10, true},
                                  {4, 500, 100, 10, true},   {3, kAny, 100, 20, false},
                                  {2, kAny, 150, 30, false}, {1, kAny, 200, 50, false}};
  const auto lit = [&](double value) { return value <= dark_below ? 0.0 : value; };
  for (const Row& row : kRows) {
    if (lit(c.from_70) <= row.at_70 && lit(c.from_80) <= row.at_80 && lit(c.from_90) <= row.at_90 &&
        (!row.none_beyond_95 || lit(c.beyond_95) == 0.0))
      return row.number;
  }
  return 0;
}

}  // namespace

double street_side_c_deg(const PhotometricOrigin& origin, IesTurn ies_turn) {
  return origin.format.starts_with("IES") && ies_turn == IesTurn::none ? 0.0 : 90.0;
}

LuminaireZones luminaire_zones(const IntensityDistribution& d, double street_c_deg) {
  check_luminous(d, "luminaire classification");
  if (!std::isfinite(street_c_deg))
    throw InputError(fmt::format("luminaire classification: street side at C {}", street_c_deg));
  const IntensityDistribution front = half_of(d, street_c_deg - 90.0), back = half_of(d, street_c_deg + 90.0);
  const auto up = [&](double from, double to) { return zonal_flux(d, from, to); };
  return {.front_low = zonal_flux(front, 0.0, 30.0),
          .front_medium = zonal_flux(front, 30.0, 60.0),
          .front_high = zonal_flux(front, 60.0, 80.0),
          .front_very_high = zonal_flux(front, 80.0, 90.0),
          .back_low = zonal_flux(back, 0.0, 30.0),
          .back_medium = zonal_flux(back, 30.0, 60.0),
          .back_high = zonal_flux(back, 60.0, 80.0),
          .back_very_high = zonal_flux(back, 80.0, 90.0),
          .up_low = up(90.0, 100.0),
          .up_high = up(100.0, 180.0)};
}

std::string BugRating::text() const { return fmt::format("B{}-U{}-G{}", backlight, uplight, glare); }

BugRating bug_rating(const IntensityDistribution& distribution, const BugOptions& options) {
  check_threshold(options.dark_below_lm, "BUG rating");
  BugRating result{.zones = luminaire_zones(distribution, options.street_side_c_deg)};
  const BugNumbers rated = rate(result.zones, options.type_v, options.dark_below_lm);
  result.backlight = rated.backlight;
  result.uplight = rated.uplight;
  result.glare = rated.glare;
  result.threshold_used = !(rated == rate(result.zones, options.type_v, 0.0));
  return result;
}

std::string GlareClass::text() const { return number == 0 ? "none" : fmt::format("G*{}", number); }

GlareClass glare_class(const IntensityDistribution& d, double dark_below_cd_per_klm) {
  check_luminous(d, "luminous intensity class");
  check_threshold(dark_below_cd_per_klm, "luminous intensity class");
  const double flux = total_flux(d);
  if (!(flux > 0.0)) throw InputError("luminous intensity class: the luminaire is dark");
  const double per_klm = 1000.0 / flux;
  GlareClass result{.from_70 = per_klm * largest_from(d, 70.0, false),
                    .from_80 = per_klm * largest_from(d, 80.0, false),
                    .from_90 = per_klm * largest_from(d, 90.0, false),
                    .beyond_95 = per_klm * largest_from(d, 95.0, true)};
  result.number = class_number(result, dark_below_cd_per_klm);
  result.threshold_used = result.number != class_number(result, 0.0);
  return result;
}

}  // namespace lucerna
