// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/text/text_rays.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/text_file.h"
#include "lucerna/rayset/formats/lighttools/lighttools_ascii.h"
#include "lucerna/rayset/formats/zemax/zemax_text.h"

namespace lucerna {

namespace {

constexpr std::size_t kTextHead = 1 << 16;
constexpr std::string_view kColumns = "# columns:";
constexpr std::array<std::string_view, 7> kMain{"x", "y", "z", "kx", "ky", "kz", "flux"};

std::vector<std::string> words_in(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c != ' ' && c != '\t' && c != ',' && c != '\r') {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// What is known before the rays.
struct TextHead {
  std::vector<std::string> columns;  // declared
  std::optional<double> flux_lm, flux_w;
  std::uint64_t data_byte = 0, data_line = 1;
  std::vector<double> first;  // numbers of the first ray
};

TextHead read_text_head(const InputFile& file) {
  TextHead head;
  const std::string text = head_of(file, kTextHead);
  const auto lines = lines_in(text);
  head.data_byte = file.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto value = [&](std::string_view key) -> std::optional<double> {
      if (!lines[i].starts_with(key)) return std::nullopt;
      const auto n = numbers_in(lines[i].substr(key.size()));
      return n && n->size() == 1 && std::isfinite((*n)[0]) && (*n)[0] > 0.0 ? std::optional((*n)[0])
                                                                            : std::nullopt;
    };
    if (lines[i].starts_with(kColumns)) head.columns = words_in(lines[i].substr(kColumns.size()));
    if (const auto lm = value("# flux_lm:")) head.flux_lm = lm;
    if (const auto w = value("# flux_w:")) head.flux_w = w;
    const auto numbers = numbers_in(lines[i]);
    if (!numbers || numbers->size() < 7) continue;
    head.first = *numbers;
    head.data_byte = static_cast<std::uint64_t>(lines[i].data() - text.data());
    head.data_line = i + 1;
    break;
  }
  return head;
}

/// Turns names of columns into a layout.
class TextColumns {
 public:
  TextColumns(const InputFile& file, const std::vector<std::string>& names, RayFileFacts& facts)
      : file_(file), facts_(facts) {
    layout.floats = names.size();
    for (RecordColumn& column : layout.main) column.at = -1;
    for (std::size_t c = 0; c < names.size(); ++c) add(names[c], static_cast<int>(c));
    for (std::size_t m = 0; m < 7; ++m) {
      if (layout.main[m].at < 0)
        throw_input_error(file.name(), "", "a column '{}' expected, columns '{}' found", kMain[m],
                          fmt::join(names, " "));
    }
  }

  RecordLayout layout;
  bool has_flux_unit = false;

 private:
  void add(const std::string& name, int at) {
    const std::size_t bar = name.find('_');
    const std::string base = name.substr(0, bar), unit = bar == name.npos ? "" : name.substr(bar + 1);
    const auto main = static_cast<std::size_t>(std::ranges::find(kMain, base) - kMain.begin());
    if (main < 7) {
      if (layout.main[main].at >= 0)
        throw_input_error(file_.name(), "", "column '{}' is declared twice", base);
      layout.main[main].at = at;
      if (main < 3) set_length(layout.main[main], name, unit);
      if (main == 6) set_flux(name, unit);
      return;
    }
    if (name == "-") return;
    const bool wavelength = name == "wavelength_nm" || name == "wavelength_um" || name == "wavelength";
    layout.extra.push_back({at, name == "wavelength_um" ? 1000.0 : 1.0});
    facts_.header.columns.push_back(
        wavelength ? ColumnSpec{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}
                   : ColumnSpec{ColumnKind::additional, name});
  }

  void set_length(RecordColumn& column, const std::string& name, const std::string& unit) {
    const auto scale = mm_per(unit.empty() ? "mm" : unit);
    if (!scale)
      throw_input_error(file_.name(), "", "column '{}': mm, cm, m, inch, feet, um or nm expected", name);
    column.scale = *scale;
    facts_.length_unit = unit.empty() ? "mm" : unit;
  }

  void set_flux(const std::string& name, const std::string& unit) {
    if (unit != "lm" && unit != "w" && !unit.empty())
      throw_input_error(file_.name(), "", "column '{}': flux, flux_lm or flux_w expected", name);
    has_flux_unit = !unit.empty();
    facts_.header.flux_unit = unit == "w" ? FluxUnit::watt : FluxUnit::lumen;
  }

  const InputFile& file_;
  RayFileFacts& facts_;
};

class TextRaysWriter final : public RayWriter {
 public:
  TextRaysWriter(const std::filesystem::path& path, const RaySetHeader& header)
      : writer_(path, layout_for(header)) {
    if (!header.spectra.empty()) warnings_.push_back("text has no place for the spectral table");
    if (header.wavelength_nm) warnings_.push_back("text has no place for the wavelength of all rays");
    if (header.texts != RaySetTexts{}) warnings_.push_back("text has no place for the texts");
    std::string names =
        fmt::format("x_mm y_mm z_mm kx ky kz flux_{}", header.flux_unit == FluxUnit::lumen ? "lm" : "w");
    for (const ColumnSpec& column : header.columns) names += ' ' + name_of(column);
    writer_.write_text(fmt::format("{} {}\n", kColumns, names));
    if (header.flux_lm)
      writer_.write_text(fmt::format("# flux_lm: {}\n", static_cast<float>(*header.flux_lm)));
    if (header.flux_w) writer_.write_text(fmt::format("# flux_w: {}\n", static_cast<float>(*header.flux_w)));
  }

  void write(const RayBlock& block) override { writer_.write_rays(block); }
  void finish() override { writer_.file().commit(); }

 private:
  /// A name that is one word and does not read as one of the main columns.
  static std::string name_of(const ColumnSpec& column) {
    if (column.kind == ColumnKind::wavelength_nm) return "wavelength_nm";
    std::string name;
    for (const char c : column.label)
      name += static_cast<unsigned char>(c) <= ' ' || c == ',' || c == '_' ? '-' : c;
    return name.empty() || name == "-" || name == "wavelength" ||
                   std::ranges::find(kMain, name) != kMain.end()
               ? "column-" + name
               : name;
  }

  static RecordLayout layout_for(const RaySetHeader& header) {
    RecordLayout layout;
    for (std::size_t c = 0; c < header.columns.size(); ++c)
      layout.extra.push_back({static_cast<int>(layout.floats++)});
    return layout;
  }

  TextRayWriter writer_;
};

}  // namespace

bool looks_like_text_rays(const InputFile& file) {
  if (!is_text(file) || looks_like_lighttools_ascii(file) || looks_like_zemax_text(file)) return false;
  const TextHead head = read_text_head(file);
  if (!head.columns.empty()) return true;
  if (head.first.size() < 7) return false;
  const double square =
      head.first[3] * head.first[3] + head.first[4] * head.first[4] + head.first[5] * head.first[5];
  return std::abs(square - 1.0) <= kDirectionTolerance;
}

std::unique_ptr<RayReader> open_text_rays(InputFile file, const ReadOptions& options) {
  const TextHead head = read_text_head(file);
  RayFileFacts facts;
  facts.format = "text";
  std::vector<std::string> names = options.text_columns.empty() ? head.columns : options.text_columns;
  if (names.empty()) {
    if (head.first.empty())
      throw_input_error(file.name(), "", "a line of 7 numbers or more expected in the first {} bytes",
                        kTextHead);
    names.assign(kMain.begin(), kMain.end());
    for (std::size_t c = 7; c < head.first.size(); ++c) names.push_back(fmt::format("column{}", c + 1));
    facts.warnings.push_back("no columns are declared: x y z (mm) kx ky kz flux assumed");
  }
  const TextColumns columns(file, names, facts);
  facts.header.flux_lm = head.flux_lm;
  facts.header.flux_w = head.flux_w;
  if (!columns.has_flux_unit) {
    if (head.flux_w && !head.flux_lm) {
      facts.header.flux_unit = FluxUnit::watt;
    } else if (!head.flux_lm) {
      facts.warnings.push_back("the file does not say lm or W: lm is assumed");
    }
  }
  TextLayout layout{columns.layout, head.data_byte, file.size(), head.data_line};
  facts.ray_count = count_lines(file, layout.begin, layout.end);
  if (layout.numbers.floats > 64)
    throw_input_error(file.name(), "", "{} columns declared, 64 at most expected", layout.numbers.floats);
  return std::make_unique<TextReader>(std::move(file), std::move(facts), std::move(layout), options.salvage);
}

std::unique_ptr<RayWriter> create_text_rays(const std::filesystem::path& path, const RaySetHeader& header,
                                            const WriteOptions& options) {
  if (options.length_unit != "mm")
    throw UsageError(fmt::format("text: lengths are mm, not {}", options.length_unit));
  return std::make_unique<TextRaysWriter>(path, header);
}

}  // namespace lucerna
