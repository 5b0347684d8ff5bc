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

/// LM-63-2002 allows 256 characters a line with CR LF; 1995's 132 offend nobody.
constexpr std::size_t kLineLength = 130;

void append_line(std::string& out, const std::string& line) { out += line + "\r\n"; }

/// A keyword with its text; further lines, and what is too long for one, continue with [MORE].
void append_keyword(std::string& out, const std::string& key, const std::string& text) {
  std::string prefix = "[" + key + "] ";
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    std::string rest = one_line(text.substr(from, end - from));
    do {
      std::size_t length = std::min(rest.size(), kLineLength - prefix.size());
      if (length < rest.size()) {
        const std::size_t blank = rest.rfind(' ', length);
        if (blank != std::string::npos && blank > 0) length = blank;
        while (length > 1 && (static_cast<unsigned char>(rest[length]) & 0xC0) == 0x80) --length;
      }
      append_line(out, prefix + rest.substr(0, length));
      rest = one_line(rest.substr(length));
      prefix = "[MORE] ";
    } while (!rest.empty());
    from = end + 1;
  }
}

/// Values separated by blanks, broken over lines.
class Record {
 public:
  explicit Record(std::string& out) : out_(out) {}
  ~Record() {
    if (!line_.empty()) append_line(out_, line_);
  }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;
  void add(const std::string& value) {
    if (!line_.empty() && line_.size() + 1 + value.size() > kLineLength) {
      append_line(out_, line_);
      line_.clear();
    }
    if (!line_.empty()) line_ += ' ';
    line_ += value;
  }

 private:
  std::string& out_;
  std::string line_;
};

const char* header(PhotometricFormat format) {
  return format == PhotometricFormat::ies_2019 ? "IES:LM-63-2019" : "IESNA:LM-63-2002";
}

std::string or_unknown(const std::string& text) { return text.empty() ? "unknown" : text; }

void append_keywords(std::string& out, const PhotometricFile& file, PhotometricFormat format) {
  const LuminaireData& l = file.luminaire;
  append_keyword(out, "TEST", or_unknown(l.report_number));
  append_keyword(out, "TESTLAB", or_unknown(l.test_lab));
  append_keyword(out, "ISSUEDATE", or_unknown(l.date_user));
  append_keyword(out, "MANUFAC", or_unknown(l.manufacturer));
  if (!l.catalog_number.empty()) append_keyword(out, "LUMCAT", l.catalog_number);
  if (!l.name.empty()) append_keyword(out, "LUMINAIRE", l.name);
  if (!l.lamps.empty() && !l.lamps.front().type.empty()) append_keyword(out, "LAMP", l.lamps.front().type);
  if (format == PhotometricFormat::ies_2019 && !l.generation_info.empty()) {
    append_keyword(out, "FILEGENINFO", l.generation_info);
  }
  if (file.distribution.unit == FluxUnit::watt) append_keyword(out, "_INTENSITYUNITS", "W/sr");
  for (const auto& [key, text] : l.keywords) append_keyword(out, key, text);
}

/// LM-63-2002's size codes: negative for round. `width` lies along H 90-270, `length` along H 0-180.
void append_sizes(Record& record, const LuminaireData& l, IesTurn turn) {
  double width = 1e-3 * l.luminous_width_mm, length = 1e-3 * l.luminous_length_mm;
  double height = 1e-3 * *std::max_element(l.luminous_height_mm.begin(), l.luminous_height_mm.end());
  if (width == 0.0 && length > 0.0) {
    width = length = -length;
  } else if (turn == IesTurn::none) {
    std::swap(width, length);
  }
  if (width == 0.0 && length == 0.0) height = 0.0;  // a lone height has no code
  for (const double size : {width, length, height}) record.add(number_text(size, 6));
}

/// The planes to print (index, printed H). A closing plane at 360 repeats the first.
std::vector<std::pair<std::size_t, double>> printed_planes(const IntensityDistribution& d, double tolerance) {
  double last = 360.0;
  switch (find_symmetry(d, tolerance)) {
    case Symmetry::rotational:
      return {{0, 0.0}};
    case Symmetry::both_planes:
      last = 90.0;
      break;
    case Symmetry::plane_c0_c180:
      last = 180.0;
      break;
    case Symmetry::plane_c90_c270:
    case Symmetry::none:
      break;
  }
  std::vector<std::pair<std::size_t, double>> planes;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    if (d.c_deg[c] <= last + 1e-6) planes.emplace_back(c, d.c_deg[c]);
  }
  if (last == 360.0) planes.emplace_back(0, 360.0);
  return planes;
}

void check_writable(const IntensityDistribution& d) {
  if (const std::string fault = grid_fault(d); !fault.empty()) throw InputError("IES: " + fault);
  check_vertical_angles(d, "IES");
}

}  // namespace

std::string ies_text(const PhotometricFile& file, PhotometricFormat format,
                     const PhotometricWriteOptions& options) {
  LUCERNA_CHECK(format != PhotometricFormat::ldt, "not an IES format");
  check_writable(file.distribution);
  const LuminaireData& l = file.luminaire;
  const IntensityDistribution d =
      options.ies_turn == IesTurn::minus_90 ? turned(file.distribution, 90.0) : file.distribution;
  const int decimals = decimals_for(*std::max_element(d.cd.begin(), d.cd.end()), options.digits);
  const auto planes = printed_planes(d, decimals < 0 ? 0.0 : 0.5 * std::pow(10.0, -decimals));

  std::string out;
  append_line(out, header(format));
  append_keywords(out, file, format);
  append_line(out, "TILT=NONE");
  const std::optional<double> lamp_flux = lamp_flux_lm(l);
  const int lamps = !l.lamps.empty() && l.lamps.front().count > 0 ? l.lamps.front().count : 1;
  {
    Record record(out);
    record.add(std::to_string(lamps));
    record.add(lamp_flux ? number_text(*lamp_flux / lamps, -1) : "-1");
    record.add("1");
    record.add(std::to_string(d.gamma_deg.size()));
    record.add(std::to_string(planes.size()));
    record.add("1");
    record.add("2");
    append_sizes(record, l, options.ies_turn);
  }
  const std::string generation = l.generation_type.empty() ? kGenerationUndefined : l.generation_type;
  append_line(out, fmt::format("1 {} {}", format == PhotometricFormat::ies_2019 ? generation : "1",
                               number_text(l.input_watts, 3)));
  {
    Record record(out);
    for (const double g : d.gamma_deg) record.add(number_text(g, -1));
  }
  {
    Record record(out);
    for (const auto& plane : planes) record.add(number_text(plane.second, -1));
  }
  for (const auto& plane : planes) {
    Record record(out);
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g)
      record.add(number_text(d.at(plane.first, g), decimals));
  }
  return out;
}

}  // namespace lucerna
