// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/zemax/zemax_text.h"

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/text_file.h"
#include "lucerna/rayset/formats/zemax/zemax_units.h"

namespace lucerna {

namespace {

constexpr std::size_t kZemaxHead = 1 << 14;
constexpr double kMaxTextRays = 4294967295.0;
/// Room that the writer leaves for the count, which it learns last.
constexpr int kCountWidth = 11;

struct FirstLine {
  std::uint64_t rays = 0;
  std::size_t units = 0;
  bool spectral = false, lumen = false;
  std::uint64_t bytes = 0;  // with its end
  std::size_t columns = 7;  // of the line behind it
};

std::optional<FirstLine> first_line(const InputFile& file) {
  const std::string head = head_of(file, kZemaxHead);
  const auto lines = lines_in(head);
  if (lines.empty()) return std::nullopt;
  auto n = numbers_in(lines[0]);
  if (!n || n->size() < 2 || n->size() > 8) return std::nullopt;
  n->resize(8, 0.0);
  const auto& v = *n;
  const auto whole = [](double x, double max) { return x >= 0.0 && x <= max && x == std::floor(x); };
  if (!whole(v[0], kMaxTextRays + 1.0) || !whole(v[1], 4.0) || !whole(v[2], 2.0) || !whole(v[3], 1.0))
    return std::nullopt;
  for (std::size_t i = 4; i < 8; ++i) {
    if (v[i] != 0.0) return std::nullopt;
  }
  FirstLine line;
  // The numbers above are float32, which rounds counts beyond 2^24: read the integer that stands there.
  const std::string_view text = lines[0].substr(std::min(lines[0].find_first_not_of(" \t"), lines[0].size()));
  for (const char c : text) {
    if (c < '0' || c > '9' || line.rays > static_cast<std::uint64_t>(kMaxTextRays)) break;
    line.rays = 10 * line.rays + static_cast<std::uint64_t>(c - '0');
  }
  line.units = static_cast<std::size_t>(v[1]);
  line.spectral = v[2] == 2.0;
  line.lumen = v[3] == 1.0;
  line.bytes =
      std::min<std::uint64_t>(head.find('\n') == head.npos ? head.size() : head.find('\n') + 1, file.size());
  line.columns = line.spectral ? 8 : 7;
  if (lines.size() > 1) {
    const auto ray = numbers_in(lines[1]);
    if (!ray || (ray->size() != 7 && ray->size() != 8))
      return line.rays == 0 ? std::optional(line) : std::nullopt;
    line.columns = ray->size();
  }
  return line;
}

class ZemaxTextWriter final : public RayWriter {
 public:
  ZemaxTextWriter(const std::filesystem::path& path, const RaySetHeader& header, const WriteOptions& options)
      : writer_(path, layout_for(header, options)) {
    warnings_ = losses(header, "zemax-text",
                       {.wavelengths = spectral_, .one_wavelength = false, .table = false, .texts = false});
    if (header.flux())
      warnings_.push_back("zemax-text has no place for the total flux: readers will ask for it");
    writer_.write_text(fmt::format("{:<{}} {} {} {}\n", 0, kCountWidth, zemax::unit_code(options.length_unit),
                                   spectral_ ? 2 : 0, header.flux_unit == FluxUnit::lumen ? 1 : 0));
  }

  void write(const RayBlock& block) override { writer_.write_rays(block); }

  void finish() override {
    if (static_cast<double>(writer_.ray_count()) > kMaxTextRays)
      throw InputError("zemax-text holds 2^32 - 1 rays at most");
    const std::string count = fmt::format("{:<{}}", writer_.ray_count(), kCountWidth);
    writer_.file().patch(0, std::as_bytes(std::span(count)));
    writer_.file().commit();
  }

 private:
  RecordLayout layout_for(const RaySetHeader& header, const WriteOptions& options) {
    zemax::unit_code(options.length_unit);
    spectral_ = zemax::is_spectral(header);
    return written_layout(header, options.length_unit, spectral_ ? zemax::kNmPerWavelength : 0.0);
  }

  bool spectral_ = false;
  TextRayWriter writer_;
};

}  // namespace

bool looks_like_zemax_text(const InputFile& file) { return is_text(file) && first_line(file).has_value(); }

std::unique_ptr<RayReader> open_zemax_text(InputFile file, const ReadOptions& options) {
  const auto first = first_line(file);
  if (!first)
    throw_input_error(file.name(), "line 1",
                      "'NbrRays DimensionUnits' and lines of 7 or 8 numbers expected, other text found");
  RayFileFacts facts;
  facts.format = "zemax-text";
  facts.length_unit = zemax::kUnits[first->units];
  facts.header.flux_unit = first->lumen ? FluxUnit::lumen : FluxUnit::watt;
  if ((first->columns == 8) != first->spectral) {
    facts.warnings.push_back(
        fmt::format("line 1: ray format {} announced, but lines have {} numbers: these decide",
                    first->spectral ? 2 : 0, first->columns));
  }
  TextLayout layout;
  layout.begin = first->bytes;
  layout.end = file.size();
  layout.first_line = 2;
  layout.numbers.floats = first->columns;
  layout.numbers.scale_lengths(*mm_per(facts.length_unit));
  if (first->columns == 8) {
    facts.header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
    layout.numbers.extra = {{7, 1000.0}};
  }
  const std::uint64_t lines = count_lines(file, layout.begin, layout.end);
  facts.ray_count = std::min(lines, first->rays);
  if (lines < first->rays) {
    const std::string what = fmt::format("{} rays expected, {} lines found", first->rays, lines);
    if (!options.salvage) throw_input_error_for("salvage", file.name(), "line 1", "{}", what);
    facts.warnings.push_back(fmt::format("line 1: {}", what));
  } else if (lines > first->rays) {
    facts.warnings.push_back(
        fmt::format("line 1: {} rays announced, {} lines found: the rest is left out", first->rays, lines));
  }
  return std::make_unique<TextReader>(std::move(file), std::move(facts), std::move(layout), options.salvage);
}

std::unique_ptr<RayWriter> create_zemax_text(const std::filesystem::path& path, const RaySetHeader& header,
                                             const WriteOptions& options) {
  return std::make_unique<ZemaxTextWriter>(path, header, options);
}

}  // namespace lucerna
