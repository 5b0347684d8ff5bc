// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/zemax/zemax_binary.h"

#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"
#include "lucerna/rayset/formats/zemax/zemax_units.h"

namespace lucerna {

namespace {

constexpr std::int32_t kZemax = 1010, kProSource = 8675309;
constexpr std::size_t kRayCountAt = 4, kDescriptionAt = 8, kDescriptionSize = 100, kSourceFluxAt = 108,
                      kRaySetFluxAt = 112, kWavelengthAt = 116, kUnitsAt = 136, kRayFormatAt = 192,
                      kFluxTypeAt = 196, kZemaxHeaderSize = 208;
constexpr std::int32_t kFluxOnly = 0, kSpectral = 2;
constexpr std::uint64_t kZemaxProbe = 1024;

std::vector<std::byte> header_of(const InputFile& file) {
  std::vector<std::byte> head(kZemaxHeaderSize);
  file.read_at(0, head);
  return head;
}

std::optional<double> declared(std::span<const std::byte> head, std::size_t offset) {
  const auto value = load<float>(head, offset);
  if (std::isfinite(value) && value > 0.0F) return value;
  return std::nullopt;
}

bool visible_um(float value) { return value >= 0.3F && value <= 0.9F; }

/// True if the seventh numbers all look like visible wavelengths in micrometres and none of the eighth does.
bool is_swapped(const InputFile& file, std::uint64_t rays) {
  const std::vector<float> records = peek_records(file, kZemaxHeaderSize, 8, std::min(kZemaxProbe, rays));
  for (std::size_t i = 0; i < records.size(); i += 8) {
    if (!visible_um(records[i + 6]) || visible_um(records[i + 7])) return false;
  }
  return !records.empty();
}

class ZemaxBinaryWriter final : public RayWriter {
 public:
  ZemaxBinaryWriter(const std::filesystem::path& path, const RaySetHeader& header,
                    const WriteOptions& options)
      : writer_(path, layout_for(header, options)) {
    warnings_ = losses(header, "zemax-binary",
                       {.wavelengths = spectral_,
                        .one_wavelength = !spectral_,
                        .table = false,
                        .source_name = true,
                        .texts = false});
    std::vector<std::byte> head(kZemaxHeaderSize);
    store(head, 0, kZemax);
    store_text(head, kDescriptionAt, kDescriptionSize, header.texts.light_source);
    const auto flux = static_cast<float>(header.flux().value_or(0.0));
    store(head, kSourceFluxAt, flux);
    store(head, kRaySetFluxAt, flux);
    if (!spectral_ && header.wavelength_nm) store(head, kWavelengthAt, *header.wavelength_nm / 1000.0F);
    store(head, kUnitsAt, zemax::unit_code(options.length_unit));
    store(head, kRayFormatAt, spectral_ ? kSpectral : kFluxOnly);
    store(head, kFluxTypeAt, std::int32_t{header.flux_unit == FluxUnit::lumen});
    writer_.write_bytes(head);
  }

  void write(const RayBlock& block) override {
    writer_.write_rays(block);
    if (writer_.ray_count() > std::numeric_limits<std::uint32_t>::max()) {
      throw InputError(fmt::format("{}: zemax-binary holds {} rays at most", writer_.file().path().string(),
                                   std::numeric_limits<std::uint32_t>::max()));
    }
  }

  void finish() override {
    const auto count = static_cast<std::uint32_t>(writer_.ray_count());
    writer_.file().patch(kRayCountAt, std::as_bytes(std::span(&count, 1)));
    writer_.file().commit();
  }

 private:
  RecordLayout layout_for(const RaySetHeader& header, const WriteOptions& options) {
    zemax::unit_code(options.length_unit);
    spectral_ = zemax::is_spectral(header);
    return written_layout(header, options.length_unit, spectral_ ? zemax::kNmPerWavelength : 0.0);
  }

  bool spectral_ = false;
  RecordWriter writer_;
};

}  // namespace

bool looks_like_zemax_binary(const InputFile& file) {
  if (file.size() < 4) return false;
  std::array<std::byte, 4> word{};
  file.read_at(0, word);
  const auto id = load<std::int32_t>(word, 0);
  if (id != kZemax && id != kProSource) return false;
  if (file.size() < kZemaxHeaderSize) return true;  // cut short: the opener says so
  const auto head = header_of(file);
  const auto units = load<std::int32_t>(head, kUnitsAt), format = load<std::int32_t>(head, kRayFormatAt);
  return units >= 0 && units < 5 && format >= 0 && format <= 2;
}

std::unique_ptr<RayReader> open_zemax_binary(InputFile file, const ReadOptions& options) {
  const auto head = header_of(file);
  const auto code = [&](std::size_t offset, std::string_view what,
                        std::initializer_list<std::int32_t> allowed) {
    const auto value = load<std::int32_t>(head, offset);
    if (std::ranges::find(allowed, value) == allowed.end()) {
      throw_input_error(file.name(), fmt::format("byte {}", offset), "{} {} found, {} expected", what, value,
                        fmt::join(allowed, " or "));
    }
    return value;
  };
  code(0, "identifier", {kZemax, kProSource});
  RayFileFacts facts;
  facts.format = "zemax-binary";
  facts.length_unit = zemax::kUnits[static_cast<std::size_t>(code(kUnitsAt, "length unit", {0, 1, 2, 3, 4}))];
  const bool spectral = code(kRayFormatAt, "ray format", {kFluxOnly, kSpectral}) == kSpectral;
  const bool lumen = code(kFluxTypeAt, "flux type", {0, 1}) == 1;
  if (spectral && lumen)
    facts.warnings.push_back(fmt::format("byte {}: spectral rays with lumen, watt expected", kFluxTypeAt));
  RaySetHeader& header = facts.header;
  header.flux_unit = lumen ? FluxUnit::lumen : FluxUnit::watt;
  const auto source = declared(head, kSourceFluxAt), rays = declared(head, kRaySetFluxAt);
  if (const auto flux = rays ? rays : source) header.set_flux(*flux);
  if (source && rays && std::abs(*source - *rays) > 0.01 * *rays) {
    facts.warnings.push_back(
        fmt::format("byte {}: the source has {:g} {unit}, the ray set {:g} {unit}: the ray set's is taken",
                    kSourceFluxAt, *source, *rays, fmt::arg("unit", symbol(header.flux_unit))));
  }
  header.texts.light_source = load_text(head, kDescriptionAt, kDescriptionSize);
  RecordLayout layout;
  layout.first_byte = kZemaxHeaderSize;
  layout.scale_lengths(*mm_per(facts.length_unit));
  if (spectral) {
    layout.floats = 8;
    header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
    layout.extra = {{7, 1000.0}};
  } else if (const auto wavelength = declared(head, kWavelengthAt)) {
    header.wavelength_nm = static_cast<float>(1000.0 * *wavelength);
  }
  facts.ray_count = whole_records(file, load<std::uint32_t>(head, kRayCountAt), kRayCountAt, kZemaxHeaderSize,
                                  layout.record_bytes(), options.salvage, facts.warnings);
  if (spectral && is_swapped(file, facts.ray_count)) {
    constexpr std::string_view kSwapped =
        "flux and wavelength are swapped: the flux column holds visible wavelengths, the "
        "wavelength column none";
    if (!options.salvage) throw_input_error_for("salvage", file.name(), "byte 232", "{}", kSwapped);
    facts.warnings.push_back(fmt::format("byte 232: {}: read the other way round", kSwapped));
    layout.main[6].at = 7;
    layout.extra[0].at = 6;
  }
  return std::make_unique<RecordReader>(std::move(file), std::move(facts), std::move(layout),
                                        options.salvage);
}

std::unique_ptr<RayWriter> create_zemax_binary(const std::filesystem::path& path, const RaySetHeader& header,
                                               const WriteOptions& options) {
  return std::make_unique<ZemaxBinaryWriter>(path, header, options);
}

}  // namespace lucerna
