// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>

#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/data/symmetry.h"
#include "lucerna/photometry/formats/expand_grid.h"
#include "lucerna/photometry/formats/ies_body.h"
#include "lucerna/photometry/formats/type_ab.h"

namespace lucerna {

namespace {

constexpr double kMmPerFoot = 304.8;

std::string upper_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

/// The year of the standard by the first line, 1986 where there is no header.
int version_of(std::string_view first_line, RepairLog& log) {
  struct Header {
    std::string_view text;
    int year;
  };
  static constexpr Header kHeaders[] = {{"IESNA91", 1991},
                                        {"IESNA:LM-63-1991", 1991},
                                        {"IESNA:LM-63-1995", 1995},
                                        {"IESNA:LM-63-2002", 2002},
                                        {"IES:LM-63-2019", 2019}};
  const std::string_view line = trimmed(first_line);
  for (const Header& header : kHeaders) {
    if (line == header.text) return header.year;
  }
  const std::string upper = upper_case(line);
  if (!upper.starts_with("IES")) return 1986;
  for (const auto& [digits, year] :
       {std::pair{"2019", 2019}, {"2002", 2002}, {"95", 1995}, {"91", 1991}, {"86", 1986}}) {
    if (upper.find(digits) != std::string::npos) {
      log.repair(1, "header '{}' read as LM-63-{}", line.substr(0, 60), year);
      return year;
    }
  }
  log.repair(1, "unknown header '{}' read as LM-63-2002", line.substr(0, 60));
  return 2002;
}

/// True if `line` is the TILT line; `value` receives what follows the equals sign.
bool is_tilt_line(std::string_view line, std::string_view& value) {
  std::string_view rest = trimmed(line);
  if (rest.size() < 5 || upper_case(rest.substr(0, 4)) != "TILT") return false;
  rest = trimmed(rest.substr(4));
  if (!rest.starts_with('=')) return false;
  value = trimmed(rest.substr(1));
  return true;
}

/// Text joined into one line for a field.
std::string joined(const std::string& text) {
  std::string out = text;
  std::replace(out.begin(), out.end(), '\n', ' ');
  return out;
}

struct Keyword {
  std::string key, text;
  std::size_t line;
};

/// The label part, lines 2 to the TILT line (1 to, in 1986).
std::vector<Keyword> read_label(const std::vector<std::string_view>& lines, std::size_t from, std::size_t to,
                                int year, RepairLog& log) {
  std::vector<Keyword> keywords;
  for (std::size_t i = from; i < to; ++i) {
    const std::string_view line = trimmed(lines[i]);
    const std::size_t longest = year == 2002 ? 254 : year == 2019 ? lines[i].size() : 130;
    if (lines[i].size() > longest) {
      log.note(i + 1, "{} characters, LM-63-{} allows {} with the line end", lines[i].size(), year,
               longest + 2);
    }
    if (line.empty()) continue;
    const std::size_t close = line.find(']');
    if (line.front() == '[' && close != std::string_view::npos) {
      const std::string key(trimmed(line.substr(1, close - 1)));
      const std::string text(trimmed(line.substr(close + 1)));
      if (upper_case(key) == "MORE" && !keywords.empty()) {
        keywords.back().text += "\n" + text;
      } else {
        keywords.push_back({key, text, i + 1});
      }
      continue;
    }
    if (year > 1986) log.repair(i + 1, "'{}' is no keyword: kept as [OTHER]", line.substr(0, 40));
    keywords.push_back({"OTHER", std::string(line), i + 1});
  }
  return keywords;
}

/// Puts the keywords where they belong; unknown ones keep their order.
void assign_keywords(const std::vector<Keyword>& keywords, PhotometricFile& file) {
  LuminaireData& l = file.luminaire;
  std::string lamp;
  const std::pair<const char*, std::string*> fields[] = {{"TEST", &l.report_number},
                                                         {"TESTLAB", &l.test_lab},
                                                         {"ISSUEDATE", &l.date_user},
                                                         {"MANUFAC", &l.manufacturer},
                                                         {"LUMCAT", &l.catalog_number},
                                                         {"LUMINAIRE", &l.name},
                                                         {"LAMP", &lamp},
                                                         {"FILEGENINFO", &l.generation_info}};
  std::vector<std::string> seen;
  for (const Keyword& keyword : keywords) {
    const std::string key = upper_case(keyword.key);
    const auto field =
        std::find_if(std::begin(fields), std::end(fields), [&](const auto& f) { return key == f.first; });
    if (key == "_INTENSITYUNITS") continue;
    if (field == std::end(fields) || std::find(seen.begin(), seen.end(), key) != seen.end()) {
      l.keywords.emplace_back(keyword.key, keyword.text);
      continue;
    }
    seen.push_back(key);
    *field->second = joined(keyword.text);
  }
  for (const char* key : {"_ABSOLUTELUMENS", "_TOTALLUMINAIRELUMENS"}) {
    for (const Keyword& keyword : keywords) {
      if (upper_case(keyword.key) == key) file.origin.declared_flux_lm = number_from(keyword.text);
    }
  }
  if (!lamp.empty()) l.lamps.push_back({.count = 1, .type = lamp});
}

/// W/sr per unit of the file, or nothing for candela.
std::optional<double> radiant_unit(const std::vector<Keyword>& keywords, RepairLog& log) {
  for (const Keyword& keyword : keywords) {
    if (upper_case(keyword.key) != "_INTENSITYUNITS") continue;
    const std::string unit = upper_case(keyword.text);
    if (unit == "CD" || unit == "CANDELA") return std::nullopt;
    if (keyword.text == "mW/sr") return 1e-3;
    if (unit == "W/SR") return 1.0;
    if (keyword.text == "uW/sr" || keyword.text == "µW/sr") return 1e-6;
    log.repair(keyword.line, "intensity unit '{}' is not known: taken as cd", keyword.text);
  }
  return std::nullopt;
}

void check_required(const std::vector<Keyword>& keywords, int year, RepairLog& log) {
  if (year < 2002) return;
  for (const char* key : {"TEST", "TESTLAB", "ISSUEDATE", "MANUFAC"}) {
    const bool there = std::any_of(keywords.begin(), keywords.end(),
                                   [&](const Keyword& k) { return upper_case(k.key) == key; });
    if (!there) log.repair(0, "the keyword [{}] that LM-63-{} requires is missing", key, year);
  }
}

/// The factor on all values (see `read_ies`).
double intensity_factor(const IesBody& body, int year, PhotometricOrigin& origin, RepairLog& log) {
  if (!(body.multiplier > 0.0))
    log.fail(body.first_line, "candela multiplier {}, more than 0 expected", body.multiplier);
  origin.multiplier = body.multiplier;
  origin.ballast_factor = body.ballast_factor;
  if (!(body.ballast_factor > 0.0)) {
    log.repair(body.first_line, "ballast factor {}: 1 taken", body.ballast_factor);
    origin.ballast_factor = 1.0;
  }
  double factor = origin.multiplier * origin.ballast_factor;
  if (origin.ballast_factor != 1.0)
    log.note(body.first_line, "ballast factor {} applied", origin.ballast_factor);
  if (body.multiplier != 1.0) log.note(body.first_line, "multiplier {} applied", body.multiplier);
  if (year >= 1995 || body.second_factor == 1.0) {
    // 2019: a file generation type, 1.0 to 1.111; earlier "future use", 1.
    if (year < 2019 && body.second_factor != 1.0) {
      log.repair(body.v_line, "the value for future use is {}, 1 expected: not applied", body.second_factor);
    }
    return factor;
  }
  if (!(body.second_factor > 0.0)) {
    log.repair(body.v_line, "ballast-lamp photometric factor {}: 1 taken", body.second_factor);
    return factor;
  }
  log.note(body.v_line, "ballast-lamp photometric factor {} applied", body.second_factor);
  return factor * body.second_factor;
}

/// LM-63-2019's second value of record 2. What is no such type (a ballast's factor, as before 1995) says
/// nothing.
void assign_generation(const IesBody& body, int year, LuminaireData& luminaire, RepairLog& log) {
  if (year < 2019 || body.second_text == kGenerationUndefined) return;
  if (body.second_factor >= 1.0 && body.second_factor < 1.2) {
    luminaire.generation_type = std::string(body.second_text);
  } else {
    log.repair(body.v_line, "file generation type {}, 1 to 1.111 expected: taken as not said",
               body.second_text);
  }
}

/// LM-63's luminous opening; round and other shapes by negative values.
void assign_sizes(const IesBody& body, IesTurn turn, PhotometricFile& file, RepairLog& log) {
  file.origin.raw_size = {body.width, body.length, body.height};
  file.origin.feet = body.units == 1;
  if (body.units != 1 && body.units != 2) {
    log.repair(body.first_line, "unit of length {}, 1 (feet) or 2 (m) expected: m taken", body.units);
  }
  const double mm = body.units == 1 ? kMmPerFoot : 1000.0;
  const auto size_mm = [&](double size) { return std::round(1e9 * std::abs(size) * mm) / 1e9; };
  double width = size_mm(body.width), length = size_mm(body.length);
  LuminaireData& l = file.luminaire;
  const bool round =
      body.width < 0.0 && body.height >= 0.0 && (body.length == 0.0 || body.length == body.width);
  if (round) {
    length = width;
    width = 0.0;
  } else {
    if (body.width < 0.0 || body.length < 0.0 || body.height < 0.0) {
      log.note(body.first_line,
               "sizes {} {} {} stand for another shape than a box or disc: their outer size kept", body.width,
               body.length, body.height);
    }
    if (turn == IesTurn::none) std::swap(width, length);
  }
  l.luminous_length_mm = l.length_mm = length;
  l.luminous_width_mm = l.width_mm = width;
  l.height_mm = size_mm(body.height);
  l.luminous_height_mm.fill(l.height_mm);
}

void assign_lamps(const IesBody& body, PhotometricFile& file, RepairLog& log) {
  LuminaireData& l = file.luminaire;
  l.input_watts = body.input_watts;
  l.absolute = body.lumens_per_lamp < 0.0;
  if (body.lumens_per_lamp < 0.0 && body.lumens_per_lamp != -1.0) {
    log.repair(body.first_line, "lumens per lamp {}: taken as -1, absolute photometry", body.lumens_per_lamp);
  }
  if (body.lumens_per_lamp == 0.0) {
    log.repair(body.first_line, "lumens per lamp 0: taken as -1, absolute photometry");
    l.absolute = true;
  }
  if (l.lamps.empty()) l.lamps.emplace_back();
  double lamps = body.lamps;
  if (!(lamps >= 1.0 && lamps <= 1e6 && lamps == std::floor(lamps))) {
    log.repair(body.first_line, "number of lamps {}: 1 taken", lamps);
    lamps = 1.0;
  }
  l.lamps.front().count = static_cast<int>(lamps);
  l.lamps.front().watts = body.input_watts;
  if (!l.absolute) l.lamps.front().flux_lm = lamps * body.lumens_per_lamp;
}

/// The planes in [0, 360) ascending from 0, where a file has -180..180 or leaves out the plane at 360.
void wrap_planes(ListedGrid& grid, RepairLog& log) {
  auto& h = grid.planes_deg;
  const std::size_t n = h.size(), nv = grid.gammas_deg.size();
  const double span = h.back() - h.front();
  if (h.front() == 0.0 || span < 180.0 || span > 360.0 + kEqualAngle_deg) return;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < n; ++i) {
    double c = std::fmod(h[i], 360.0);
    if (c < 0.0) c += 360.0;
    if (i + 1 == n && std::abs(span - 360.0) <= kEqualAngle_deg) continue;  // the first plane again
    order.emplace_back(c, i);
  }
  std::sort(order.begin(), order.end());
  if (std::abs(order.front().first) > kEqualAngle_deg) return;
  log.repair(grid.planes_line, "horizontal angles {} to {}: counted from 0 to 360", h.front(), h.back());
  ListedGrid sorted = grid;
  sorted.planes_deg.clear();
  sorted.cd.clear();
  for (const auto& [c, i] : order) {
    sorted.planes_deg.push_back(c);
    const auto row = grid.cd.begin() + static_cast<std::ptrdiff_t>(i * nv);
    sorted.cd.insert(sorted.cd.end(), row, row + static_cast<std::ptrdiff_t>(nv));
  }
  grid = std::move(sorted);
}

/// What the last horizontal angle of Type C says.
ListedSymmetry type_c_symmetry(ListedGrid& grid, int year, RepairLog& log) {
  auto& h = grid.planes_deg;
  const auto is = [](double a, double b) { return std::abs(a - b) <= kEqualAngle_deg; };
  if (h.size() == 1) {
    if (h.front() != 0.0)
      log.repair(grid.planes_line, "the only horizontal angle is {}, 0 expected: taken as axial", h.front());
    return ListedSymmetry::rotational;
  }
  if (is(h.front(), 90.0) && is(h.back(), 270.0)) {
    if (year > 1995)
      log.repair(grid.planes_line, "horizontal angles 90 to 270 are of LM-63-1995: mirrored on C90-C270");
    return ListedSymmetry::half_90_270;
  }
  wrap_planes(grid, log);
  const double last = h.back();
  if (is(last, 90.0)) return ListedSymmetry::quarter;
  if (is(last, 180.0)) return ListedSymmetry::half_0_180;
  if (last > 180.0 && !is(last, 360.0) && last < 360.0) {
    const double step = last - h[h.size() - 2];
    if (year != 1995 || !is(360.0 - last, step)) {
      log.repair(grid.planes_line,
                 "horizontal angles end at {}, 360 expected: the circle closed with the plane at 0", last);
    }
  }
  return ListedSymmetry::full;  // `expanded` fails on anything that does not go round
}

IntensityDistribution read_type_ab(const IesBody& body, double factor, RepairLog& log, double& scale_used) {
  TypeAbGrid grid;
  grid.type = body.type == 2 ? 'B' : 'A';
  grid.h_deg = body.h_deg;
  grid.v_deg = body.v_deg;
  const auto check = [&](const std::vector<double>& angles, std::size_t line, const char* what) {
    if (angles.size() < 2) log.fail(line, "one {} angle, at least 2 needed for type {}", what, grid.type);
    for (std::size_t i = 1; i < angles.size(); ++i) {
      if (!(angles[i] > angles[i - 1]))
        log.fail(line, "{} angles do not ascend: {} after {}", what, angles[i], angles[i - 1]);
    }
    const double first = angles.front(), last = angles.back();
    if (first < -90.0 || last > 90.0)
      log.fail(line, "{} angles {} to {} found, -90 to 90 expected", what, first, last);
    if ((first != -90.0 && first != 0.0) || last != 90.0) {
      log.repair(line, "{} angles {} to {} found, -90 or 0 to 90 expected: dark beyond", what, first, last);
    }
  };
  check(grid.h_deg, body.h_line, "horizontal");
  check(grid.v_deg, body.v_line, "vertical");
  grid.mirrored_h = grid.h_deg.front() == 0.0;
  std::size_t negative = 0;
  for (const double value : body.values) {
    negative += value < 0.0 ? 1 : 0;
    grid.cd.push_back(std::max(0.0, value * factor));
  }
  if (negative > 0) log.repair(body.values_line, "{} negative intensities set to 0", negative);
  return type_c_from_ab(grid, scale_used);
}

IntensityDistribution read_intensities(const IesBody& body, double factor, int year, IesTurn turn,
                                       PhotometricOrigin& origin, RepairLog& log) {
  if (body.type < 1 || body.type > 3) {
    log.repair(body.first_line, "photometric type {}, 1 (C), 2 (B) or 3 (A) expected: C taken", body.type);
  }
  origin.type = body.type == 2 ? 'B' : body.type == 3 ? 'A' : 'C';
  origin.planes = body.h_deg.size();
  origin.gammas = body.v_deg.size();
  origin.symmetry = fmt::format("H {}..{}", body.h_deg.front(), body.h_deg.back());
  if (origin.type != 'C') {
    double scale_used = 1.0;
    IntensityDistribution d = read_type_ab(body, factor, log, scale_used);
    log.note(body.first_line,
             "type {} turned to type C with H0 V0 on nadir and V90 on C0, values x {:.5f} for its own flux",
             origin.type, scale_used);
    return d;
  }
  ListedGrid grid{body.h_deg, body.v_deg, body.values, body.h_line, body.v_line, body.values_line};
  for (double& value : grid.cd) value *= factor;
  const ListedSymmetry symmetry = type_c_symmetry(grid, year, log);
  IntensityDistribution d = expanded(std::move(grid), symmetry, log, origin.nadir_spread);
  return turn == IesTurn::minus_90 ? turned(d, -90.0) : d;
}

/// Keeps the factors and says what they are. They scale all intensities with the angle by which the lamp is
/// tilted, which only an installation knows.
void report_tilt(const IesBody& body, std::size_t line, PhotometricOrigin& origin, RepairLog& log) {
  origin.tilt_factors = body.tilt_factors;
  origin.tilt_geometry = body.tilt_geometry;
  if (body.tilt_factors.empty()) {
    log.note(line, "0 tilt factors");
    return;
  }
  const auto [min, max] =
      std::minmax_element(body.tilt_factors.begin(), body.tilt_factors.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
  log.note(line,
           "{} tilt factors kept, not applied: {} to {} for lamp tilts of {} to {} deg (lamp geometry {}); "
           "intensities hold for the luminaire as measured",
           body.tilt_factors.size(), min->second, max->second, body.tilt_factors.front().first,
           body.tilt_factors.back().first, body.tilt_geometry);
}

}  // namespace

PhotometricFile read_ies(std::string_view bytes, std::string_view name,
                         const PhotometricReadOptions& options) {
  RepairLog log(std::string(name), options.strict);
  const std::string text = decoded_text(bytes);
  const std::vector<std::string_view> lines = lines_of(text);
  if (lines.empty()) log.fail(0, "empty file, an IES LM-63 file expected");
  const int year = version_of(lines.front(), log);
  std::string_view tilt;
  std::size_t at = 0;
  while (at < lines.size() && !is_tilt_line(lines[at], tilt)) ++at;
  if (at == lines.size())
    log.fail(0, "no TILT= line in {} lines: not an IES LM-63 file, or cut short", lines.size());
  const std::string tilt_upper = upper_case(tilt);
  const bool included = tilt_upper == "INCLUDE";
  if (lines[at] != "TILT=" + std::string(tilt) ||
      (tilt_upper != tilt && (included || tilt_upper == "NONE"))) {
    log.repair(at + 1, "'{}' read as TILT={}", trimmed(lines[at]).substr(0, 60), tilt_upper.substr(0, 40));
  }

  PhotometricFile file;
  file.origin.format = fmt::format("IES LM-63-{}", year);
  const std::vector<Keyword> keywords = read_label(lines, year > 1986 ? 1 : 0, at, year, log);
  check_required(keywords, year, log);
  assign_keywords(keywords, file);
  if (!included && tilt_upper != "NONE") {
    log.repair(at + 1, "the lamp tilt file '{}' is not read: intensities hold for the untilted lamp",
               tilt.substr(0, 60));
  }
  const IesBody body = parse_ies_body(lines, at + 1, included, log);
  if (included) report_tilt(body, at + 2, file.origin, log);
  double factor = intensity_factor(body, year, file.origin, log);
  assign_generation(body, year, file.luminaire, log);
  const std::optional<double> radiant = radiant_unit(keywords, log);
  if (radiant) factor *= *radiant;
  assign_sizes(body, options.ies_turn, file, log);
  assign_lamps(body, file, log);
  file.distribution = read_intensities(body, factor, year, options.ies_turn, file.origin, log);
  if (radiant) file.distribution.unit = FluxUnit::watt;
  if (const std::string fault = grid_fault(file.distribution); !fault.empty())
    log.fail(body.values_line, "{}", fault);
  file.repairs = std::move(log.repairs);
  file.notes = std::move(log.notes);
  return file;
}

}  // namespace lucerna
