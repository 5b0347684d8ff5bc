// SPDX-License-Identifier: Apache-2.0
// read(write(x)) = x for random distributions of every symmetry, and what every version and type of LM-63
// says against an emitter of its own in this file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/data/symmetry.h"
#include "lucerna/photometry/formats/type_ab.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

/// `from`, `to` and up to `max` multiples of 2.5 between them.
std::vector<double> random_angles(Rng& rng, double from, double to, std::uint32_t max) {
  std::set<double> angles{from, to};
  for (std::uint32_t i = rng.bits() % (max + 1); i > 0; --i)
    angles.insert(from + 2.5 * std::floor(rng.uniform() * (to - from) / 2.5));
  return {angles.begin(), angles.end()};
}

/// The planes C that the symmetry makes of the stored ones.
std::vector<double> mirrored(const std::vector<double>& stored, Symmetry symmetry) {
  std::set<double> planes;
  for (const double c : stored) {
    const auto add = [&](double angle) { planes.insert(std::fmod(angle + 720.0, 360.0)); };
    add(c);
    if (symmetry == Symmetry::plane_c0_c180 || symmetry == Symmetry::both_planes) add(-c);
    if (symmetry == Symmetry::plane_c90_c270 || symmetry == Symmetry::both_planes) add(180.0 - c);
    if (symmetry == Symmetry::both_planes) add(180.0 + c);
  }
  return {planes.begin(), planes.end()};
}

/// The stored plane that plane `c` mirrors.
double stored_plane(double c, Symmetry symmetry) {
  if (symmetry == Symmetry::plane_c0_c180 || symmetry == Symmetry::both_planes) c = c > 180.0 ? 360.0 - c : c;
  if (symmetry == Symmetry::plane_c90_c270) return c > 90.0 && c < 270.0 ? std::fmod(540.0 - c, 360.0) : c;
  if (symmetry == Symmetry::both_planes) c = c > 90.0 ? 180.0 - c : c;
  return c;
}

/// Six decades of random values on a random grid with this symmetry and no higher one.
IntensityDistribution random_distribution(Rng& rng, Symmetry symmetry) {
  std::vector<double> planes{0.0};
  if (symmetry == Symmetry::both_planes) planes = mirrored(random_angles(rng, 0.0, 90.0, 6), symmetry);
  if (symmetry == Symmetry::plane_c0_c180) planes = mirrored(random_angles(rng, 0.0, 180.0, 9), symmetry);
  if (symmetry == Symmetry::plane_c90_c270) planes = mirrored(random_angles(rng, 90.0, 270.0, 9), symmetry);
  if (symmetry == Symmetry::none) planes = random_angles(rng, 0.0, 357.5, 15);
  if (symmetry != Symmetry::rotational) {
    std::set<double> with_axes(planes.begin(), planes.end());
    with_axes.insert({0.0, 90.0, 180.0, 270.0});
    planes.assign(with_axes.begin(), with_axes.end());
  }
  const double ranges[3][2] = {{0.0, 90.0}, {90.0, 180.0}, {0.0, 180.0}};
  const auto& range = ranges[rng.bits() % 3];
  std::vector<double> gammas = random_angles(rng, range[0], range[1], 12);
  if (gammas.size() == 2)
    gammas.insert(gammas.begin() + 1, 0.5 * (range[0] + range[1]));  // poles have no planes
  IntensityDistribution d = zero_distribution(planes, gammas);
  std::map<std::pair<double, double>, double> values;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      const bool pole = d.gamma_deg[g] == 0.0 || d.gamma_deg[g] == 180.0;
      const auto key = std::pair(pole ? 0.0 : stored_plane(d.c_deg[c], symmetry), d.gamma_deg[g]);
      if (!values.contains(key)) values[key] = std::pow(10.0, 6.0 * rng.uniform() - 2.0);
      d.at(c, g) = values[key];
    }
  }
  return d;
}

LuminaireData random_luminaire(Rng& rng) {
  const auto size = [&] { return 0.5 * static_cast<double>(rng.bits() % 4000 + 1); };
  LuminaireData l;
  l.manufacturer = "Größe & Söhne " + std::to_string(rng.bits() % 1000);
  l.name = "Luminaire " + std::to_string(rng.bits() % 1000);
  l.catalog_number = std::to_string(rng.bits());
  l.report_number = "R" + std::to_string(rng.bits() % 1000);
  l.date_user = "2026-11-20";
  l.luminous_length_mm = size();
  l.luminous_width_mm = rng.bits() % 3 == 0 ? 0.0 : size();
  l.luminous_height_mm.fill(0.0);
  l.input_watts = size();
  l.absolute = rng.bits() % 2 == 0;
  if (!l.absolute) {
    const int count = static_cast<int>(rng.bits() % 3) + 1;
    l.lamps = {{.count = count, .type = "T16", .flux_lm = count * size(), .watts = l.input_watts}};
  }
  return l;
}

void expect_same(const IntensityDistribution& a, const IntensityDistribution& b, double relative) {
  ASSERT_EQ(a.c_deg, b.c_deg);
  ASSERT_EQ(a.gamma_deg, b.gamma_deg);
  for (std::size_t i = 0; i < a.cd.size(); ++i) ASSERT_NEAR(a.cd[i], b.cd[i], relative * a.cd[i]) << i;
}

void expect_same(const LuminaireData& a, const LuminaireData& b) {
  EXPECT_EQ(a.manufacturer, b.manufacturer);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.catalog_number, b.catalog_number);
  EXPECT_EQ(a.report_number, b.report_number);
  EXPECT_EQ(a.date_user, b.date_user);
  EXPECT_NEAR(a.luminous_length_mm, b.luminous_length_mm, 1e-9);
  EXPECT_NEAR(a.luminous_width_mm, b.luminous_width_mm, 1e-9);
  EXPECT_NEAR(a.input_watts, b.input_watts, 1e-9);
  EXPECT_EQ(a.absolute, b.absolute);
  ASSERT_EQ(lamp_flux_lm(a).has_value(), lamp_flux_lm(b).has_value());
  if (lamp_flux_lm(a)) {
    EXPECT_NEAR(*lamp_flux_lm(a), *lamp_flux_lm(b), 1e-9);
    EXPECT_EQ(a.lamps.front().count, b.lamps.front().count);
  }
}

constexpr Symmetry kSymmetries[] = {Symmetry::none, Symmetry::rotational, Symmetry::plane_c0_c180,
                                    Symmetry::plane_c90_c270, Symmetry::both_planes};

TEST(PhotometricRoundTrip, EverySymmetryInEveryFormatWeWrite) {
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    for (const Symmetry symmetry : kSymmetries) {
      SCOPED_TRACE(fmt::format("trial {} symmetry {}", trial, static_cast<int>(symmetry)));
      Rng rng(7, trial, static_cast<std::uint32_t>(symmetry));
      PhotometricFile x;
      x.distribution = random_distribution(rng, symmetry);
      x.luminaire = random_luminaire(rng);
      for (const PhotometricFormat format : {PhotometricFormat::ies_2002, PhotometricFormat::ies_2019}) {
        for (const IesTurn turn : {IesTurn::none, IesTurn::minus_90}) {
          const std::string text = ies_text(x, format, {.ies_turn = turn, .digits = 17});
          const PhotometricFile back = read_ies(text, "round trip", {.strict = true, .ies_turn = turn});
          expect_same(x.distribution, back.distribution, 0.0);
          expect_same(x.luminaire, back.luminaire);
          EXPECT_EQ(ies_text(back, format, {.ies_turn = turn, .digits = 17}).size(), text.size());
        }
      }
      const PhotometricFile back = read_ldt(ldt_text(x, {.digits = 17}), "round trip", {.strict = true});
      expect_same(x.distribution, back.distribution, 1e-14);  // to cd/klm and back: four roundings
      expect_same(x.luminaire, back.luminaire);
      EXPECT_EQ(static_cast<int>(find_symmetry(back.distribution, 0.0)), static_cast<int>(symmetry));
    }
  }
}

// Printed with 5 digits of the peak, no value moves by more than half a unit of the last, and symmetric ones
// stay symmetric.
TEST(PhotometricRoundTrip, FewDigitsCostHalfAUnit) {
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    Rng rng(8, trial);
    PhotometricFile x;
    x.distribution = random_distribution(rng, kSymmetries[trial % 5]);
    const double peak = *std::max_element(x.distribution.cd.begin(), x.distribution.cd.end());
    const double half = 0.5 * std::pow(10.0, std::floor(std::log10(peak)) - 4.0) * (1.0 + 1e-9);
    const std::string text = ies_text(x, PhotometricFormat::ies_2019, {.digits = 5});
    const PhotometricFile back = read_ies(text, "round trip", {.strict = true});
    for (std::size_t i = 0; i < x.distribution.cd.size(); ++i)
      ASSERT_NEAR(back.distribution.cd[i], x.distribution.cd[i], half) << trial << " " << i;
    EXPECT_EQ(ies_text(back, PhotometricFormat::ies_2019, {.digits = 5}), text);
  }
}

/// An LM-63 file as a version's text describes it, independent of our writer.
struct EmittedIes {
  int year = 2002, type = 1;
  std::vector<double> h, v, values;  ///< for each h all v
  double multiplier = 1.0, ballast = 1.0, second = 1.0;
  std::vector<std::pair<double, double>> tilt{};

  std::string text() const {
    const std::map<int, std::string> headers{{1986, "A luminaire\n"},
                                             {1991, "IESNA91\n"},
                                             {1995, "IESNA:LM-63-1995\n"},
                                             {2002, "IESNA:LM-63-2002\n"},
                                             {2019, "IES:LM-63-2019\n"}};
    std::string out = headers.at(year);
    if (year > 1986) out += "[TEST] 1\n[TESTLAB] here\n[ISSUEDATE] today\n[MANUFAC] us\n";
    if (year == 2019) out += "[FILEGENINFO] none\n";
    out += tilt.empty() ? "TILT=NONE\n" : fmt::format("TILT=INCLUDE\n1\n{}\n", tilt.size());
    for (const auto& entry : tilt) out += fmt::format("{} ", entry.first);
    if (!tilt.empty()) out += '\n';
    for (const auto& entry : tilt) out += fmt::format("{} ", entry.second);
    if (!tilt.empty()) out += '\n';
    out += fmt::format("1 -1 {} {} {} {} 2 0 0 0\n{} {} 100\n", multiplier, v.size(), h.size(), type, ballast,
                       second);
    for (const std::vector<double>* list : {&v, &h, &values}) {
      for (std::size_t i = 0; i < list->size(); ++i)
        out += fmt::format("{}{}", (*list)[i], i % 8 == 7 ? '\n' : ' ');
      out += '\n';
    }
    return out;
  }

  /// Only 1986 and 1991 multiply by the second value of record 2.
  double factor() const { return multiplier * ballast * (year <= 1991 ? second : 1.0); }
};

EmittedIes random_ies(Rng& rng, int year, int type) {
  EmittedIes e{.year = year, .type = type};
  e.multiplier = 0.25 * static_cast<double>(1 + rng.bits() % 12);
  e.ballast = 0.5 + 0.5 * rng.uniform();
  e.second = year == 2019 ? 1.1 : year <= 1991 ? 0.9 : 1.0;
  if (rng.bits() % 3 == 0) e.tilt = {{0.0, 1.0}, {45.0, 0.9}, {90.0, 0.8}};
  return e;
}

TEST(PhotometricRoundTrip, TypeCOfEveryVersion) {
  for (const int year : {1986, 1991, 1995, 2002, 2019}) {
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
      SCOPED_TRACE(fmt::format("{} trial {}", year, trial));
      Rng rng(static_cast<std::uint64_t>(year), trial);
      EmittedIes e = random_ies(rng, year, 1);
      const double ends[5][2] = {{0, 0}, {0, 90}, {0, 180}, {0, 360}, {90, 270}};
      const auto& end = ends[trial % (year == 1995 ? 5 : 4)];
      e.h = end[1] > 0.0 ? random_angles(rng, end[0], end[1], 6) : std::vector<double>{0.0};
      if (end[1] == 360.0) {  // else the planes do not go round
        std::set<double> h(e.h.begin(), e.h.end());
        h.insert({90.0, 180.0, 270.0});
        e.h.assign(h.begin(), h.end());
      }
      e.v = random_angles(rng, 0.0, trial % 2 == 0 ? 90.0 : 180.0, 8);
      for (std::size_t h = 0; h < e.h.size(); ++h) {
        for (const double v : e.v) {
          const bool pole = v == 0.0 || v == 180.0, again = e.h[h] == 360.0;
          e.values.push_back(pole    ? 100.0
                             : again ? e.values[e.values.size() - e.v.size() * h]
                                     : 1e3 * rng.uniform());
        }
      }
      const PhotometricFile file = read_ies(e.text(), "emitted", {});
      EXPECT_EQ(file.origin.format, fmt::format("IES LM-63-{}", year));
      for (std::size_t h = 0; h < e.h.size(); ++h) {
        for (std::size_t v = 0; v < e.v.size(); ++v) {
          const double expected = e.values[h * e.v.size() + v] * e.factor();
          const auto expect_at = [&](double c) {
            ASSERT_NEAR(intensity_at(file.distribution, c, e.v[v]), expected, 1e-12 * expected) << c;
          };
          expect_at(e.h[h]);
          if (end[1] == 0.0) expect_at(77.0);
          if (end[1] == 90.0) expect_at(180.0 - e.h[h]);
          if (end[1] == 90.0 || end[1] == 180.0) expect_at(-e.h[h]);
          if (end[1] == 270.0) expect_at(180.0 - e.h[h]);
        }
      }
      EXPECT_EQ(file.origin.tilt_factors, e.tilt);
      EXPECT_DOUBLE_EQ(tilt_factor(file.origin, 22.5), e.tilt.empty() ? 1.0 : 0.95);
      EXPECT_DOUBLE_EQ(tilt_factor(file.origin, 120.0), e.tilt.empty() ? 1.0 : 0.8);
    }
  }
}

TEST(PhotometricRoundTrip, TypesAAndBOfEveryVersionThroughEveryFormat) {
  for (const int year : {1991, 1995, 2002, 2019}) {
    for (const int type : {2, 3}) {
      for (std::uint64_t trial = 0; trial < 4; ++trial) {
        SCOPED_TRACE(fmt::format("{} type {} trial {}", year, type, trial));
        Rng rng(static_cast<std::uint64_t>(year + type), trial);
        EmittedIes e = random_ies(rng, year, type);
        e.h = random_angles(rng, trial % 2 == 0 ? 0.0 : -90.0, 90.0, 8);
        e.v = random_angles(rng, -90.0, 90.0, 8);
        for (std::size_t i = 0; i < e.h.size() * e.v.size(); ++i) e.values.push_back(1e3 * rng.uniform());
        TypeAbGrid grid{.type = type == 2 ? 'B' : 'A',
                        .h_deg = e.h,
                        .v_deg = e.v,
                        .cd = e.values,
                        .mirrored_h = e.h.front() == 0.0};
        for (double& value : grid.cd) value *= e.factor();
        const PhotometricFile file = read_ies(e.text(), "emitted", {});
        EXPECT_EQ(file.origin.type, grid.type);
        const double flux = type_ab_flux(grid);
        EXPECT_NEAR(total_flux(file.distribution), flux, 1e-9 * flux);
        double scale_used = 1.0;
        expect_same(type_c_from_ab(grid, scale_used), file.distribution, 1e-12);
        const PhotometricFile again =
            read_ies(ies_text(file, PhotometricFormat::ies_2019, {.digits = 17}), "again", {.strict = true});
        expect_same(file.distribution, again.distribution, 0.0);
        expect_same(file.distribution,
                    read_ldt(ldt_text(file, {.digits = 17}), "again", {.strict = true}).distribution, 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace lucerna
