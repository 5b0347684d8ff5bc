// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/data/symmetry.h"
#include "lucerna/photometry/formats/photometric_text.h"

namespace lucerna {

namespace {

/// Lines of text, CR LF, cut at `limit` bytes without cutting a UTF-8 character.
class Lines {
 public:
  void text(const std::string& line, std::size_t limit) {
    std::string cut = one_line(line);
    if (cut.size() > limit) {
      while (limit > 0 && (static_cast<unsigned char>(cut[limit]) & 0xC0) == 0x80) --limit;
      cut.resize(limit);
    }
    out_ += cut + "\r\n";
  }
  void number(double value, int decimals) { out_ += number_text(value, decimals) + "\r\n"; }
  void number(std::size_t value) { out_ += fmt::format("{}\r\n", value); }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// The common step of `angles`, or 0 if they are not equally spaced.
double common_step(const std::vector<double>& angles, double period) {
  const std::size_t n = angles.size();
  if (n < 2) return 0.0;
  const double step = (period > 0.0 ? period : angles.back() - angles.front()) /
                      static_cast<double>(n - (period > 0.0 ? 0 : 1));
  for (std::size_t i = 0; i < n; ++i) {
    if (std::abs(angles[i] - angles[0] - step * static_cast<double>(i)) > 1e-6) return 0.0;
  }
  return step;
}

/// The planes that EULUMDAT stores for a symmetry, as indices, in its order.
std::vector<std::size_t> stored_planes(const IntensityDistribution& d, Symmetry symmetry) {
  std::vector<std::size_t> planes;
  const std::size_t n = d.c_deg.size();
  const auto take = [&](double from, double to) {
    for (std::size_t c = 0; c < n; ++c) {
      if (d.c_deg[c] >= from - 1e-6 && d.c_deg[c] <= to + 1e-6) planes.push_back(c);
    }
  };
  switch (symmetry) {
    case Symmetry::none:
      take(0.0, 360.0);
      break;
    case Symmetry::rotational:
      planes.push_back(0);
      break;
    case Symmetry::plane_c0_c180:
      take(0.0, 180.0);
      break;
    case Symmetry::plane_c90_c270:
      take(270.0, 360.0);
      take(0.0, 90.0);
      break;
    case Symmetry::both_planes:
      take(0.0, 90.0);
      break;
  }
  return planes;
}

/// Isym that EULUMDAT's plane counts allow: the mirrored half must hold Mc/2+1 (or Mc/4+1) planes.
Symmetry writable_symmetry(const IntensityDistribution& d, double tolerance) {
  const Symmetry symmetry = find_symmetry(d, tolerance);
  const std::size_t n = d.c_deg.size();
  bool fits = n % (symmetry == Symmetry::both_planes ? 4 : 2) == 0;
  // Isym 3 begins at plane 3 Mc / 4 + 1, whatever its angle: it must be C270.
  if (symmetry == Symmetry::plane_c90_c270)
    fits = n % 4 == 0 && plane_index(d, 270.0) == static_cast<std::ptrdiff_t>(3 * n / 4);
  return symmetry == Symmetry::none || symmetry == Symmetry::rotational || fits ? symmetry : Symmetry::none;
}

void write_sizes(Lines& lines, const LuminaireData& l) {
  lines.number(l.length_mm, 3);
  lines.number(l.width_mm, 3);
  lines.number(l.height_mm, 3);
  lines.number(l.luminous_length_mm, 3);
  lines.number(l.luminous_width_mm, 3);
  for (const double height : l.luminous_height_mm) lines.number(height, 3);
}

void write_lamps(Lines& lines, const LuminaireData& l, double flux_lm) {
  if (l.absolute) {
    const LampSet lamp = l.lamps.empty() ? LampSet{} : l.lamps.front();
    lines.number(std::size_t{1});
    lines.text("-1", 8);
    lines.text(lamp.type.empty() ? "LED" : lamp.type, 24);
    lines.number(flux_lm, -1);
    lines.text(lamp.color, 16);
    lines.text(lamp.color_rendering, 6);
    lines.number(l.input_watts, 3);
    return;
  }
  lines.number(l.lamps.size());
  for (const LampSet& lamp : l.lamps) {
    lines.text(std::to_string(lamp.count), 8);
    lines.text(lamp.type, 24);
    lines.number(lamp.flux_lm, -1);
    lines.text(lamp.color, 16);
    lines.text(lamp.color_rendering, 6);
    lines.number(lamp.watts, 3);
  }
}

/// The 24 planes that a rotational distribution lists in use; only the first is stored.
std::vector<double> listed_planes(const IntensityDistribution& d, Symmetry symmetry) {
  if (symmetry != Symmetry::rotational || d.c_deg.size() > 1) return d.c_deg;
  std::vector<double> planes;
  for (int i = 0; i < 24; ++i) planes.push_back(15.0 * i);
  return planes;
}

}  // namespace

std::optional<double> lamp_flux_lm(const LuminaireData& luminaire) {
  if (luminaire.absolute) return std::nullopt;
  for (const LampSet& lamp : luminaire.lamps) {
    if (lamp.flux_lm > 0.0) return lamp.flux_lm;
  }
  return std::nullopt;
}

std::string ldt_text(const PhotometricFile& file, const PhotometricWriteOptions& options) {
  const IntensityDistribution& d = file.distribution;
  const LuminaireData& l = file.luminaire;
  if (const std::string fault = grid_fault(d); !fault.empty()) throw InputError("EULUMDAT: " + fault);
  check_vertical_angles(d, "EULUMDAT");
  if (d.unit != FluxUnit::lumen) throw InputError("EULUMDAT has no radiometric unit: write IES instead");
  const double flux = total_flux(d);
  const std::optional<double> lamp_flux = lamp_flux_lm(l);
  if (!l.absolute && (!lamp_flux || l.lamps.front().flux_lm != *lamp_flux)) {
    throw InputError("EULUMDAT: relative photometry needs the flux of the first lamp set");
  }
  // cd/klm of nothing is 0, and 1 lm keeps the file readable.
  const double reference_lm = lamp_flux.value_or(flux > 0.0 ? flux : 1.0);
  const double per_klm = 1000.0 / reference_lm;
  const double peak = *std::max_element(d.cd.begin(), d.cd.end()) * per_klm;
  const int decimals = decimals_for(peak, options.digits);
  const double tolerance = decimals < 0 ? 0.0 : 0.5 * std::pow(10.0, -decimals) / per_klm;
  const Symmetry symmetry = writable_symmetry(d, tolerance);
  const std::vector<double> planes = listed_planes(d, symmetry);

  Lines lines;
  lines.text(l.manufacturer, 78);
  const int type = symmetry == Symmetry::rotational ? 1 : 3;
  lines.text(std::to_string(l.type_indicator != 0 ? l.type_indicator : type), 8);
  lines.number(static_cast<std::size_t>(symmetry));
  lines.number(planes.size());
  lines.number(common_step(planes, 360.0), -1);
  lines.number(d.gamma_deg.size());
  lines.number(common_step(d.gamma_deg, 0.0), -1);
  lines.text(l.report_number, 78);
  lines.text(l.name, 78);
  lines.text(l.catalog_number, 78);
  lines.text(l.file_name, 78);
  lines.text(l.date_user, 78);
  write_sizes(lines, l);
  lines.number(flux > 0.0 ? 100.0 * zonal_flux(d, 0.0, 90.0) / flux : 0.0, 4);
  lines.number(l.absolute ? 100.0 : 100.0 * flux / reference_lm, 4);
  lines.number(1.0, 0);
  lines.number(l.tilt_deg, 3);
  write_lamps(lines, l, reference_lm);
  for (const double ratio : l.direct_ratios) lines.number(ratio, 3);
  for (const double c : planes) lines.number(c, -1);
  for (const double g : d.gamma_deg) lines.number(g, -1);
  for (const std::size_t c : stored_planes(d, symmetry)) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) lines.number(d.at(c, g) * per_klm, decimals);
  }
  return lines.take();
}

}  // namespace lucerna
