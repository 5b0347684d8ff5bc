// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/lighttools/lighttools_binary.h"

#include <cmath>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"

namespace lucerna {

namespace {

constexpr std::string_view kMagic = "LTRF", kEndMark = "LTRFEND";
constexpr std::size_t kMajor = 4, kDataType = 12, kFarField = 16, kColour = 20, kUnit = 24, kOrigin = 28,
                      kFlux = 40, kLtrfHeaderSize = 44;
constexpr std::array<std::string_view, 8> kUnitCodes{"mm", "mm", "cm", "m", "inch", "feet", "um", "nm"};
constexpr std::uint32_t kNoColour = 0, kTristimulus = 1, kWavelengths = 2;

bool has_text_at(const InputFile& file, std::uint64_t offset, std::string_view text) {
  if (offset > file.size() || text.size() > file.size() - offset) return false;
  std::string found(text.size(), '\0');
  file.read_at(offset, std::as_writable_bytes(std::span(found)));
  return found == text;
}

class BinaryOpener {
 public:
  BinaryOpener(InputFile file, bool salvage) : file_(std::move(file)), salvage_(salvage) {
    head_.resize(kLtrfHeaderSize);
    file_.read_at(0, head_);
  }

  std::unique_ptr<RayReader> open() {
    facts_.format = "lighttools-binary";
    if (!has_text_at(file_, 0, kMagic))
      throw_input_error(file_.name(), "byte 0", "'LTRF' expected, other bytes found");
    const std::uint32_t major = code(kMajor, "version", 2, 3);
    facts_.header.flux_unit = code(kDataType, "data type", 0, 1) == 1 ? FluxUnit::lumen : FluxUnit::watt;
    const bool far_field = code(kFarField, "far-field flag", 0, 1) == 1;
    const std::uint32_t colour = code(kColour, "colour", 0, 2);
    if (colour == kTristimulus) {
      throw_input_error(
          file_.name(), fmt::format("byte {}", kColour),
          "tristimulus colour found, none (0) or wavelength (2) expected: its layout is not public");
    }
    const std::uint32_t unit = code(kUnit, "length unit", 0, 7);
    if (unit == 0) warn("byte {}: lengths in 'system' units: mm assumed", kUnit);
    facts_.length_unit = kUnitCodes[unit];
    lay_out(far_field, colour == kWavelengths);
    if (major == 3) extend_to_version_3();
    place_origin();
    count_rays(major == 3);
    return std::make_unique<RecordReader>(std::move(file_), std::move(facts_), std::move(layout_), salvage_);
  }

 private:
  template <class... Args>
  void warn(fmt::format_string<Args...> text, Args&&... args) {
    facts_.warnings.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  std::uint32_t code(std::size_t offset, std::string_view what, std::uint32_t low, std::uint32_t high) const {
    const auto value = load<std::uint32_t>(head_, offset);
    if (value < low || value > high) {
      throw_input_error(file_.name(), fmt::format("byte {}", offset), "{} {} found, {} to {} expected", what,
                        value, low, high);
    }
    return value;
  }

  void lay_out(bool far_field, bool wavelengths) {
    layout_.first_byte = kLtrfHeaderSize;
    if (far_field) layout_.main = {{{-1}, {-1}, {-1}, {0}, {1}, {2}, {3}}};
    layout_.floats = far_field ? 4 : 7;
    layout_.scale_lengths(*mm_per(facts_.length_unit));
    if (wavelengths) {
      facts_.header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
      layout_.extra.push_back({static_cast<int>(layout_.floats++)});
    }
    set_flux(kFlux);
  }

  void set_flux(std::size_t offset) {
    const auto flux = load<float>(head_, offset);
    if (std::isfinite(flux) && flux > 0.0F) facts_.header.set_flux(static_cast<double>(flux));
  }

  /// One more word in the header, and S0..S3 after the rest of each ray.
  void extend_to_version_3() {
    warn("byte {}: version 3 (polarised), whose layout is known from one source only", kMajor);
    head_.resize(kLtrfHeaderSize + 4);
    file_.read_at(0, head_);
    layout_.first_byte = kLtrfHeaderSize + 4;
    // Sources differ on where the flag stands: where the flux is not.
    if (load<std::uint32_t>(head_, kLtrfHeaderSize) > 1) set_flux(kLtrfHeaderSize);
  }

  void place_origin() {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto origin = load<float>(head_, kOrigin + 4 * c);
      if (!std::isfinite(origin)) {
        throw_input_error(file_.name(), fmt::format("byte {}", kOrigin + 4 * c),
                          "data origin {} found, a number expected", origin);
      }
      layout_.main[c].offset = static_cast<double>(origin) * layout_.main[c].scale;
      if (origin != 0.0F)
        warn("byte {}: the data origin's {} = {} is added to the starts", kOrigin + 4 * c, "xyz"[c], origin);
    }
  }

  void count_rays(bool may_be_polarised) {
    const bool marked = file_.size() >= layout_.first_byte + kEndMark.size() &&
                        has_text_at(file_, file_.size() - kEndMark.size(), kEndMark);
    const std::uint64_t bytes = file_.size() - layout_.first_byte - (marked ? kEndMark.size() : 0);
    if (may_be_polarised && bytes % layout_.record_bytes() != 0 &&
        bytes % (layout_.record_bytes() + 16) == 0) {
      for (const char* label : {"S0", "S1", "S2", "S3"}) {
        facts_.header.columns.push_back({ColumnKind::additional, label});
        layout_.extra.push_back({static_cast<int>(layout_.floats++)});
      }
    }
    const std::uint64_t rays = bytes / layout_.record_bytes(), over = bytes % layout_.record_bytes();
    facts_.ray_count = rays;
    if (marked && over == 0) return;
    const std::string what = fmt::format(
        "'LTRFEND' expected after whole rays of {} bytes; the file ends after {} rays and {} bytes",
        layout_.record_bytes(), rays, over);
    if (!salvage_)
      throw_input_error_for("salvage", file_.name(), fmt::format("byte {}", file_.size()), "{}", what);
    warn("byte {}: {}: the whole ones are read", file_.size(), what);
  }

  InputFile file_;
  bool salvage_;
  std::vector<std::byte> head_;
  RayFileFacts facts_;
  RecordLayout layout_;
};

class LightToolsBinaryWriter final : public RayWriter {
 public:
  LightToolsBinaryWriter(const std::filesystem::path& path, const RaySetHeader& header,
                         const WriteOptions& options)
      : writer_(path, layout_for(header, options)) {
    const auto wavelength = find_column(header.columns, ColumnKind::wavelength_nm);
    warnings_ = losses(header, "lighttools-binary",
                       {.wavelengths = true, .one_wavelength = false, .table = false, .texts = false});
    std::vector<std::byte> head(kLtrfHeaderSize);
    std::memcpy(head.data(), kMagic.data(), kMagic.size());
    store(head, kMajor, std::uint32_t{2});
    store(head, kDataType, std::uint32_t{header.flux_unit == FluxUnit::lumen});
    store(head, kColour, wavelength ? kWavelengths : kNoColour);
    const auto unit = std::find(kUnitCodes.begin() + 1, kUnitCodes.end(), options.length_unit);
    store(head, kUnit, static_cast<std::uint32_t>(unit - kUnitCodes.begin()));
    store(head, kFlux, static_cast<float>(header.flux().value_or(0.0)));
    writer_.write_bytes(head);
  }

  void write(const RayBlock& block) override { writer_.write_rays(block); }

  void finish() override {
    writer_.write_bytes(std::as_bytes(std::span(kEndMark)));
    writer_.file().commit();
  }

 private:
  static RecordLayout layout_for(const RaySetHeader& header, const WriteOptions& options) {
    if (std::ranges::find(kUnitCodes, options.length_unit) == kUnitCodes.end()) {
      throw UsageError(fmt::format("lighttools: lengths in {}, not {}",
                                   fmt::join(std::span(kUnitCodes).subspan(1), ", "), options.length_unit));
    }
    return written_layout(header, options.length_unit, 1.0);
  }

  RecordWriter writer_;
};

}  // namespace

bool looks_like_lighttools_binary(const InputFile& file) { return has_text_at(file, 0, kMagic); }

std::unique_ptr<RayReader> open_lighttools_binary(InputFile file, const ReadOptions& options) {
  return BinaryOpener(std::move(file), options.salvage).open();
}

std::unique_ptr<RayWriter> create_lighttools_binary(const std::filesystem::path& path,
                                                    const RaySetHeader& header, const WriteOptions& options) {
  return std::make_unique<LightToolsBinaryWriter>(path, header, options);
}

}  // namespace lucerna
