// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/photometric_file.h"
#include "lucerna/photometry/data/symmetry.h"
#include "lucerna/photometry/formats/expand_grid.h"

namespace lucerna {

namespace {

/// EULUMDAT's lines in order.
class LdtLines {
 public:
  LdtLines(const std::vector<std::string_view>& lines, RepairLog& log) : lines_(lines), log_(log) {}

  std::size_t line() const { return at_ + 1; }  ///< of the next value
  std::size_t left() const { return lines_.size() - at_; }

  std::string_view text(const char* what) {
    if (at_ >= lines_.size()) log_.fail(lines_.size(), "the file ends where {} is expected", what);
    return trimmed(lines_[at_++]);
  }

  /// A number; blank reads as 0, which is a repair unless `may_be_blank`.
  double number(const char* what, bool may_be_blank = false) {
    const std::size_t here = line();
    const std::string_view found = text(what);
    if (found.empty()) {
      if (!may_be_blank) log_.repair(here, "{} is blank: 0 taken", what);
      return 0.0;
    }
    if (const auto value = number_from(found)) return *value;
    std::string with_point(found);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    if (const auto value = number_from(with_point)) {
      note_comma(here);
      return *value;
    }
    // "12 W": the number before the blank
    const std::size_t end = with_point.find_first_of(" \t");
    if (end != std::string::npos) {
      if (const auto value = number_from(with_point.substr(0, end))) {
        log_.repair(here, "'{}' read as {} for {}", found.substr(0, 40), *value, what);
        return *value;
      }
    }
    log_.fail(here, "'{}' found where {} is expected", found.substr(0, 40), what);
  }

  std::size_t count(const char* what, std::size_t lowest, std::size_t highest) {
    const std::size_t here = line();
    const double value = number(what);
    if (value != std::floor(value) || value < static_cast<double>(lowest) ||
        value > static_cast<double>(highest)) {
      log_.fail(here, "{} is {}, a whole number from {} to {} expected", what, value, lowest, highest);
    }
    return static_cast<std::size_t>(value);
  }

  std::vector<double> numbers(std::size_t n, const char* what) {
    if (n > left()) log_.fail(lines_.size(), "{} values expected for {}, {} lines left", n, what, left());
    std::vector<double> values;
    values.reserve(n);
    for (std::size_t i = 0; i < n; ++i) values.push_back(number(what));
    return values;
  }

  /// Reports decimal commas once, with their number.
  void finish() {
    if (commas_ > 0) log_.repair(first_comma_, "{} numbers with a decimal comma", commas_);
    for (; at_ < lines_.size(); ++at_) {
      if (trimmed(lines_[at_]).empty()) continue;
      log_.repair(at_ + 1, "{} lines left over, from '{}': not used", lines_.size() - at_,
                  trimmed(lines_[at_]).substr(0, 40));
      return;
    }
  }

 private:
  void note_comma(std::size_t here) {
    if (commas_++ == 0) first_comma_ = here;
  }

  const std::vector<std::string_view>& lines_;
  RepairLog& log_;
  std::size_t at_ = 0, commas_ = 0, first_comma_ = 0;
};

struct LdtHead {
  std::size_t symmetry = 0, planes = 0, gammas = 0;
  double c_step = 0.0, gamma_step = 0.0;
};

LdtHead read_head(LdtLines& in, LuminaireData& l) {
  LdtHead head;
  l.manufacturer = in.text("the company");
  l.type_indicator = static_cast<int>(in.count("the type indicator Ityp", 0, 3));
  head.symmetry = in.count("the symmetry Isym", 0, 4);
  head.planes = in.count("the number of C planes", 1, 100000);
  head.c_step = in.number("the distance of C planes");
  head.gammas = in.count("the number of gamma angles", 2, 100000);
  head.gamma_step = in.number("the distance of gamma angles");
  l.report_number = in.text("the report number");
  l.name = in.text("the luminaire name");
  l.catalog_number = in.text("the luminaire number");
  l.file_name = in.text("the file name");
  l.date_user = in.text("the date");
  return head;
}

/// Lines 13 to 25; returns the conversion factor.
double read_sizes(LdtLines& in, PhotometricFile& file, double& lorl, RepairLog& log) {
  LuminaireData& l = file.luminaire;
  const auto size = [&](const char* what) {
    const std::size_t here = in.line();
    const double value = in.number(what);
    if (value >= 0.0) return value;
    log.repair(here, "{} is {}: 0 taken", what, value);
    return 0.0;
  };
  l.length_mm = size("the length of the luminaire");
  l.width_mm = size("the width of the luminaire");
  l.height_mm = size("the height of the luminaire");
  l.luminous_length_mm = size("the length of the luminous area");
  l.luminous_width_mm = size("the width of the luminous area");
  for (double& height : l.luminous_height_mm) height = size("the height of the luminous area");
  in.number("the downward flux fraction");
  lorl = in.number("the light output ratio");
  const std::size_t here = in.line();
  double factor = in.number("the conversion factor");
  if (!(factor > 0.0)) {
    log.repair(here, "conversion factor {}: 1 taken", factor);
    factor = 1.0;
  }
  if (factor != 1.0) log.note(here, "conversion factor {} applied", factor);
  file.origin.multiplier = factor;
  l.tilt_deg = in.number("the tilt during measurement", true);
  return factor;
}

/// Lamp sets; returns the flux that cd/klm refer to.
double read_lamps(LdtLines& in, PhotometricFile& file, double lorl, RepairLog& log) {
  LuminaireData& l = file.luminaire;
  const std::size_t sets_line = in.line();
  const std::size_t sets = in.count("the number of lamp sets", 1, 1000);
  if (sets * 6 > in.left()) log.fail(sets_line, "{} lamp sets promised, {} lines left", sets, in.left());
  l.absolute = false;
  for (std::size_t i = 0; i < sets; ++i) {
    LampSet lamp;
    const std::size_t here = in.line();
    const double count = in.number("the number of lamps");
    if (count != std::floor(count) || std::abs(count) > 1e6)
      log.fail(here, "number of lamps {}, a whole number expected", count);
    if (count < 0.0 && i == 0) {
      l.absolute = true;
      log.note(here, "{} lamps: absolute photometry, the flux is the luminaire's", count);
    }
    lamp.count = static_cast<int>(std::abs(count));
    lamp.type = in.text("the lamp type");
    lamp.flux_lm = in.number("the lamp flux");
    lamp.color = in.text("the colour");
    lamp.color_rendering = in.text("the colour rendering");
    lamp.watts = in.number("the watts", true);
    if (lamp.flux_lm < 0.0) log.fail(here + 2, "lamp flux {} lm, not negative expected", lamp.flux_lm);
    l.lamps.push_back(lamp);
  }
  if (sets > 1) log.note(sets_line, "{} lamp sets: cd are for the first, {}", sets, l.lamps.front().type);
  l.input_watts = l.lamps.front().watts;
  double reference_lm = l.lamps.front().flux_lm;
  if (!(reference_lm > 0.0)) {
    log.repair(sets_line + 3, "the lamp flux is {}: 1000 lm taken, cd/klm read as cd", reference_lm);
    reference_lm = l.lamps.front().flux_lm = 1000.0;
  }
  if (lorl > 0.0) file.origin.declared_flux_lm = reference_lm * lorl / 100.0;
  return reference_lm;
}

/// How many planes are stored, and from which listed one.
struct Stored {
  std::size_t first, count;
  ListedSymmetry symmetry;
};

Stored stored_planes(const LdtHead& head, Isym3Order order) {
  const std::size_t n = head.planes;
  switch (head.symmetry) {
    case 1:
      return {0, 1, ListedSymmetry::rotational};
    case 2:
      return {0, n / 2 + 1, ListedSymmetry::half_0_180};
    case 3:
      return order == Isym3Order::standard ? Stored{3 * n / 4, n / 2 + 1, ListedSymmetry::half_270_90}
                                           : Stored{n / 4, n / 2 + 1, ListedSymmetry::half_90_270};
    case 4:
      return {0, n / 4 + 1, ListedSymmetry::quarter};
    default:
      return {0, n, ListedSymmetry::full};
  }
}

/// The angles of the stored planes, from the list of all.
std::vector<double> stored_angles(const std::vector<double>& listed, const Stored& stored, std::size_t line,
                                  RepairLog& log) {
  if (stored.symmetry == ListedSymmetry::rotational) return {0.0};
  std::vector<double> angles;
  const std::size_t n = listed.size();
  for (std::size_t i = 0; i < stored.count; ++i) {
    const std::size_t at = stored.first + i;
    if (at >= 2 * n) log.fail(line, "{} C planes are too few for this symmetry", n);
    angles.push_back(listed[at % n] + (at >= n ? 360.0 : 0.0));
  }
  return angles;
}

void check_steps(const std::vector<double>& angles, double step, std::size_t line, const char* what,
                 RepairLog& log) {
  if (!(step > 0.0)) return;
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (std::abs(angles[i] - angles[i - 1] - step) > 0.01) {
      log.repair(line, "{} angles are not {} apart as stated ({} after {}): the list is taken", what, step,
                 angles[i], angles[i - 1]);
      return;
    }
  }
}

IntensityDistribution read_intensities(LdtLines& in, const LdtHead& head, Isym3Order order,
                                       double cd_per_value, PhotometricFile& file, RepairLog& log) {
  const Stored stored = stored_planes(head, order);
  ListedGrid grid;
  grid.planes_line = in.line();
  // Some programs list only the planes that they store.
  std::size_t listed = head.planes;
  const std::size_t values = stored.count * head.gammas;
  if (stored.count < listed && in.left() < listed + head.gammas + values &&
      in.left() >= stored.count + head.gammas + values) {
    listed = stored.count;
    log.repair(grid.planes_line, "{} C angles listed, all {} expected", listed, head.planes);
  }
  if (in.left() < listed + head.gammas + values) {
    log.fail(in.line(), "{} C angles, {} gamma angles and {} intensities expected, {} lines left", listed,
             head.gammas, values, in.left());
  }
  const std::vector<double> planes = in.numbers(listed, "a C angle");
  grid.planes_deg = listed == head.planes ? stored_angles(planes, stored, grid.planes_line, log)
                    : stored.symmetry == ListedSymmetry::rotational ? std::vector<double>{0.0}
                                                                    : planes;
  if (head.symmetry == 3 && listed != head.planes) {
    // listed as 270 .. 360 .. 90: make them ascend
    for (std::size_t i = 1; i < listed; ++i) {
      if (grid.planes_deg[i] < grid.planes_deg[i - 1]) grid.planes_deg[i] += 360.0;
    }
  }
  if (listed == head.planes && head.planes > 1) check_steps(planes, head.c_step, grid.planes_line, "C", log);
  grid.gammas_line = in.line();
  grid.gammas_deg = in.numbers(head.gammas, "a gamma angle");
  check_steps(grid.gammas_deg, head.gamma_step, grid.gammas_line, "gamma", log);
  grid.values_line = in.line();
  grid.cd = in.numbers(values, "an intensity");
  for (double& value : grid.cd) value *= cd_per_value;
  return expanded(std::move(grid), stored.symmetry, log, file.origin.nadir_spread);
}

}  // namespace

PhotometricFile read_ldt(std::string_view bytes, std::string_view name,
                         const PhotometricReadOptions& options) {
  RepairLog log(std::string(name), options.strict);
  const std::string text = decoded_text(bytes);
  const std::vector<std::string_view> lines = lines_of(text);
  if (lines.size() < 26) log.fail(lines.size(), "{} lines, a EULUMDAT file has more than 26", lines.size());
  LdtLines in(lines, log);
  PhotometricFile file;
  const LdtHead head = read_head(in, file.luminaire);
  double lorl = 0.0;
  const double factor = read_sizes(in, file, lorl, log);
  const double reference_lm = read_lamps(in, file, lorl, log);
  for (double& ratio : file.luminaire.direct_ratios) ratio = in.number("a direct ratio", true);
  file.origin.format = "EULUMDAT";
  file.origin.symmetry = fmt::format("Isym {}", head.symmetry);
  file.origin.planes = head.planes;
  file.origin.gammas = head.gammas;
  file.distribution = read_intensities(in, head, options.isym3, factor * reference_lm / 1000.0, file, log);
  in.finish();
  if (const std::string fault = grid_fault(file.distribution); !fault.empty()) log.fail(0, "{}", fault);
  file.repairs = std::move(log.repairs);
  file.notes = std::move(log.notes);
  return file;
}

}  // namespace lucerna
