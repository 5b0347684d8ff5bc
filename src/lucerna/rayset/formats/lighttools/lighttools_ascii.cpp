// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/lighttools/lighttools_ascii.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/text_file.h"

namespace lucerna {

namespace {

constexpr std::size_t kAsciiHead = 1 << 16, kAsciiTail = 4096;
constexpr std::string_view kDataStart = "lt_startofdata", kDataEnd = "lt_endofdata";
struct UnitName {
  std::string_view name, label;
};
constexpr std::array<UnitName, 7> kUnitNames{{{"mm", "millimeters"},
                                              {"cm", "centimeters"},
                                              {"m", "meters"},
                                              {"inch", "inches"},
                                              {"feet", "feet"},
                                              {"um", "micrometers"},
                                              {"nm", "nanometers"}}};

std::string lower(std::string_view text) {
  std::string out;
  for (const char c : text) out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

struct Value {
  std::string text;
  std::size_t line = 1;
};

/// The header's keys in lower case, and where the rays begin.
struct AsciiHead {
  std::map<std::string, Value> keys;
  std::uint64_t data_byte = 0;
  std::size_t data_line = 0;  // 0: no lt_startofdata
  std::size_t numbers = 0;    // on the first line of data
};

AsciiHead read_ascii_head(const InputFile& file) {
  AsciiHead head;
  const std::string text = head_of(file, kAsciiHead);
  const auto lines = lines_in(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (lower(line) == kDataStart) {
      head.data_line = i + 2;
      const std::size_t line_end = text.find('\n', static_cast<std::size_t>(lines[i].data() - text.data()));
      head.data_byte = line_end == text.npos ? text.size() : line_end + 1;
      const auto first = i + 1 < lines.size() ? numbers_in(lines[i + 1]) : std::nullopt;
      head.numbers = first ? first->size() : 0;
      break;
    }
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == line.npos) continue;
    head.keys[lower(trimmed(line.substr(0, colon)))] = {std::string(trimmed(line.substr(colon + 1))), i + 1};
  }
  return head;
}

class AsciiOpener {
 public:
  AsciiOpener(InputFile file, bool salvage)
      : file_(std::move(file)), salvage_(salvage), head_(read_ascii_head(file_)) {}

  std::unique_ptr<RayReader> open() {
    facts_.format = "lighttools-ascii";
    if (head_.data_line == 0)
      throw_input_error(file_.name(), "line 1", "a line 'lt_startofdata' expected in the first {} bytes",
                        kAsciiHead);
    facts_.header.flux_unit = choice("lt_datatype", "radiant_power", {"radiant_power", "luminous_flux"}) == 1
                                  ? FluxUnit::lumen
                                  : FluxUnit::watt;
    const bool far_field = choice("lt_far_field_data", "no", {"no", "yes"}) == 1;
    const bool wavelengths = choice("lt_color_info", "none", {"none", "wavelength"}) == 1;
    read_units();
    layout_.numbers.floats = far_field ? 4 : 7;
    if (far_field) layout_.numbers.main = {{{-1}, {-1}, {-1}, {0}, {1}, {2}, {3}}};
    layout_.numbers.scale_lengths(*mm_per(facts_.length_unit));
    if (wavelengths) add_column({ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)});
    if (head_.numbers == layout_.numbers.floats + 4) {
      for (const char* label : {"S0", "S1", "S2", "S3"}) add_column({ColumnKind::additional, label});
    }
    read_flux();
    read_origin();
    find_end();
    facts_.ray_count = count_lines(file_, layout_.begin, layout_.end);
    return std::make_unique<TextReader>(std::move(file_), std::move(facts_), std::move(layout_), salvage_);
  }

 private:
  [[noreturn]] void fail(const Value& value, std::string_view key, std::string_view expected) const {
    throw_input_error(file_.name(), fmt::format("line {}", value.line), "{} '{}' found, {} expected", key,
                      value.text, expected);
  }

  std::size_t choice(const std::string& key, std::string_view standard,
                     std::initializer_list<std::string_view> names) const {
    const auto found = head_.keys.find(key);
    const std::string text = found == head_.keys.end() ? std::string(standard) : lower(found->second.text);
    const auto* name = std::ranges::find(names, text);
    if (name == names.end()) fail(found->second, key, fmt::format("{}", fmt::join(names, " or ")));
    return static_cast<std::size_t>(name - names.begin());
  }

  void add_column(ColumnSpec column) {
    facts_.header.columns.push_back(std::move(column));
    layout_.numbers.extra.push_back({static_cast<int>(layout_.numbers.floats++)});
  }

  void read_units() {
    const auto found = head_.keys.find("lt_length_units");
    if (found == head_.keys.end() || lower(found->second.text) == "system") {
      facts_.warnings.push_back("no length unit is stated: mm assumed");
      return;
    }
    std::string text = lower(found->second.text);
    if (text == "microns") text = "micrometers";
    const auto unit = std::ranges::find_if(
        kUnitNames, [&](const UnitName& u) { return text == u.label || text == u.name; });
    if (unit == kUnitNames.end()) fail(found->second, "lt_length_units", "millimeters or another unit");
    facts_.length_unit = unit->name;
  }

  void read_flux() {
    for (const char* key : {"lt_radiant_flux", "lt_luminous_flux"}) {
      const auto found = head_.keys.find(key);
      if (found == head_.keys.end()) continue;
      const auto flux = numbers_in(found->second.text);
      if (!flux || flux->size() != 1) fail(found->second, key, "a number");
      if (std::isfinite((*flux)[0]) && (*flux)[0] > 0.0) facts_.header.set_flux((*flux)[0]);
    }
  }

  void read_origin() {
    const auto found = head_.keys.find("lt_data_origin");
    if (found == head_.keys.end()) return;
    const auto origin = numbers_in(found->second.text);
    if (!origin || origin->size() != 3 || !std::isfinite((*origin)[0] + (*origin)[1] + (*origin)[2])) {
      fail(found->second, "lt_data_origin", "three numbers");
    }
    for (std::size_t c = 0; c < 3; ++c) {
      layout_.numbers.main[c].offset = (*origin)[c] * layout_.numbers.main[c].scale;
      if ((*origin)[c] != 0.0)
        facts_.warnings.push_back(
            fmt::format("line {}: the data origin is added to the starts", found->second.line));
    }
  }

  void find_end() {
    layout_.begin = head_.data_byte;
    layout_.first_line = head_.data_line;
    layout_.end = file_.size();
    const std::uint64_t from =
        std::max(layout_.begin, file_.size() > kAsciiTail ? file_.size() - kAsciiTail : 0);
    std::string tail(file_.size() - from, '\0');
    file_.read_at(from, std::as_writable_bytes(std::span(tail)));
    if (const std::size_t at = lower(tail).rfind(kDataEnd); at != tail.npos) {
      layout_.end = from + at;
    } else if (salvage_) {
      facts_.warnings.push_back(
          "'lt_endofdata' is missing: the file was cut short; the whole lines are read");
      // The last line may be half a ray; it goes with its line end.
      const std::size_t line_end = tail.rfind('\n');
      layout_.end = line_end == tail.npos ? layout_.begin : from + line_end + 1;
    } else {
      throw_input_error_for("salvage", file_.name(), fmt::format("byte {}", file_.size()),
                            "'lt_endofdata' expected before the end of the file: it was cut short");
    }
  }

  InputFile file_;
  bool salvage_;
  AsciiHead head_;
  RayFileFacts facts_;
  TextLayout layout_;
};

class LightToolsAsciiWriter final : public RayWriter {
 public:
  LightToolsAsciiWriter(const std::filesystem::path& path, const RaySetHeader& header,
                        const WriteOptions& options)
      : writer_(path, layout_for(header, options)) {
    warnings_ = losses(
        header, "lighttools-ascii",
        {.wavelengths = true, .one_wavelength = false, .table = false, .source_name = true, .texts = false});
    const bool lumen = header.flux_unit == FluxUnit::lumen;
    const bool wavelengths = find_column(header.columns, ColumnKind::wavelength_nm).has_value();
    std::string name = header.texts.light_source.empty() ? "rays" : header.texts.light_source;
    std::ranges::replace_if(
        name, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    writer_.write_text(
        fmt::format("# Ray data\nlt_rdf_version: 2.0\ndataname: {}\nlt_datatype: {}\nlt_far_field_data: no\n",
                    name, lumen ? "luminous_flux" : "radiant_power"));
    writer_.write_text(
        fmt::format("lt_color_info: {}\nlt_length_units: {}\nlt_data_origin: 0 0 0\n",
                    wavelengths ? "wavelength" : "none",
                    std::ranges::find(kUnitNames, options.length_unit, &UnitName::name)->label));
    if (const auto flux = header.flux())
      writer_.write_text(fmt::format("lt_radiant_flux: {}\n", static_cast<float>(*flux)));
    writer_.write_text(fmt::format("{}\n", kDataStart));
  }

  void write(const RayBlock& block) override { writer_.write_rays(block); }
  void finish() override {
    writer_.write_text(fmt::format("{}\n", kDataEnd));
    writer_.file().commit();
  }

 private:
  static RecordLayout layout_for(const RaySetHeader& header, const WriteOptions& options) {
    if (std::ranges::find(kUnitNames, options.length_unit, &UnitName::name) == kUnitNames.end()) {
      throw UsageError(
          fmt::format("lighttools: lengths in mm, cm, m, inch, feet, um or nm, not {}", options.length_unit));
    }
    return written_layout(header, options.length_unit, 1.0);
  }

  TextRayWriter writer_;
};

}  // namespace

bool looks_like_lighttools_ascii(const InputFile& file) {
  if (!is_text(file)) return false;
  const std::string head = lower(head_of(file, 4096));
  return std::ranges::any_of(lines_in(head),
                             [](std::string_view line) { return trimmed(line).starts_with("lt_"); });
}

std::unique_ptr<RayReader> open_lighttools_ascii(InputFile file, const ReadOptions& options) {
  return AsciiOpener(std::move(file), options.salvage).open();
}

std::unique_ptr<RayWriter> create_lighttools_ascii(const std::filesystem::path& path,
                                                   const RaySetHeader& header, const WriteOptions& options) {
  return std::make_unique<LightToolsAsciiWriter>(path, header, options);
}

}  // namespace lucerna
