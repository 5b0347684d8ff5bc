// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"
#include "lucerna/rayset/formats/tm25/tm25.h"
#include "lucerna/rayset/formats/tm25/tm25_layout.h"
#include "lucerna/rayset/formats/tm25/utf32.h"

namespace lucerna {

using namespace tm25;

namespace {

// What a header may ask for at most, so that memory stays bounded whatever the bytes say; far above any real
// file.
constexpr std::uint64_t kMaxSpectralPairs = 1 << 20, kMaxItems = 256, kMaxTextBytes = 1 << 24;

/// Rays whose directions are looked at to tell a right start of the ray block from a wrong one.
constexpr std::uint64_t kTm25Probe = 64;

class Tm25Opener {
 public:
  Tm25Opener(InputFile file, const ReadOptions& options) : file_(std::move(file)), options_(options) {}

  std::unique_ptr<RayReader> open() {
    read_header();
    read_flags();
    read_texts();
    read_spectra();
    read_labels();
    make_columns();
    place_rays();
    facts_.format = "tm25";
    return std::make_unique<RecordReader>(std::move(file_), std::move(facts_), std::move(layout_),
                                          options_.salvage);
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(std::uint64_t byte, fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_.name(), fmt::format("byte {}", byte), text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void warn(fmt::format_string<Args...> text, Args&&... args) {
    facts_.warnings.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  /// A stated quantity > 0; NaN, 0, negatives and the NaN that a big-endian writer left (2.4e-38) mean "not
  /// stated".
  std::optional<float> declared(std::size_t offset) const {
    const auto value = load<float>(head_, offset);
    const bool swapped_nan = load<std::uint32_t>(head_, offset) == 0x0100807FU ||
                             load<std::uint32_t>(head_, offset) == 0x0000C07FU;
    if (std::isfinite(value) && value > 0.0F && !swapped_nan) return value;
    return std::nullopt;
  }

  std::uint64_t count(std::size_t offset, std::uint64_t limit, std::string_view what) const {
    const auto value = load<std::int32_t>(head_, offset);
    if (value < 0 || static_cast<std::uint64_t>(value) > limit) {
      fail(offset, "{} {} found, 0 to {} expected", value, what, limit);
    }
    return static_cast<std::uint64_t>(value);
  }

  void read_header();
  void read_flags();
  void read_texts();
  void read_spectra();
  void read_labels();
  void make_columns();
  void place_rays();
  bool plausible(std::uint64_t start) const;
  void add_column(ColumnKind kind, std::size_t n = 0);
  void set_stokes(std::size_t columns);

  InputFile file_;
  ReadOptions options_;
  RayFileFacts facts_;
  RecordLayout layout_;
  std::vector<std::byte> head_ = std::vector<std::byte>(kHeaderSize);
  std::array<bool, flag_count> flag_{};
  std::vector<std::string> labels_;
  std::uint64_t tables_end_ = kHeaderSize,
                after_tables_ = 0;  // unpadded end of block D; bytes of blocks E and F
};

void Tm25Opener::read_header() {
  if (file_.size() < kHeaderSize) {
    fail(0, "a TM-25 header of {} bytes expected, the file ends at byte {}", kHeaderSize, file_.size());
  }
  file_.read_at(0, head_);
  const auto version = load<std::int32_t>(head_, kVersion);
  if (version == 2020) {
    warn("byte {}: TM-25-20 is read as TM-25-13, of which it is said to be an extension", kVersion);
  } else if (version != 2013) {
    fail(kVersion, "TM-25 version {} found, 2013 or 2020 expected", version);
  }
  RaySetHeader& header = facts_.header;
  header.creation_method = load<std::int32_t>(head_, kCreationMethod);
  header.start_position = load<std::int32_t>(head_, kStartPosition);
  header.flux_lm = declared(kFluxLm);
  header.flux_w = declared(kFluxW);
  header.texts.date = load_text(head_, kDate, kDateSize);
  facts_.ray_count = load<std::uint64_t>(head_, kRayCount);
  const auto spectral = load<std::int32_t>(head_, kSpectralId);
  if (spectral < no_spectrum || spectral > table_per_ray) {
    fail(kSpectralId, "spectral identifier {} found, 0 to 4 expected", spectral);
  }
  if (spectral == one_wavelength) {
    header.wavelength_nm = declared(kWavelength);
    if (!header.wavelength_nm)
      warn("byte {}: one wavelength for all rays is announced, none is given", kWavelength);
  }
}

void Tm25Opener::read_flags() {
  for (std::size_t f = 0; f < flag_count; ++f) {
    const auto value = load<std::int32_t>(head_, kFlags + 4 * f);
    if (value != 0 && value != 1) fail(kFlags + 4 * f, "flag {} found, 0 or 1 expected", value);
    flag_[f] = value == 1;
  }
  if (!flag_[position] || !flag_[direction])
    fail(kFlags, "rays without position or direction cannot be used");
  if (!flag_[radiant] && !flag_[luminous])
    fail(kFlags + 8, "a radiant or luminous flux per ray expected, neither found");
  const auto spectral = load<std::int32_t>(head_, kSpectralId);
  const bool per_ray = spectral == wavelength_per_ray || spectral == table_per_ray;
  if (per_ray && (!flag_[radiant] || flag_[luminous])) {
    warn("byte {}: rays with spectra of their own should carry radiant flux only", kFlags);
  }
  if (flag_[spectrum_index] != (spectral == table_per_ray)) {
    warn("byte {}: spectral identifier {} does not fit the spectrum index flag", kSpectralId, spectral);
  }
  if (flag_[wavelength] != (spectral == wavelength_per_ray)) {
    warn("byte {}: spectral identifier {} does not fit the wavelength flag", kSpectralId, spectral);
  }
  if (flag_[stokes] && !flag_[radiant]) warn("byte {}: Stokes vectors want radiant flux", kFlags);
  if (flag_[tristimulus] && (!flag_[luminous] || spectral != no_spectrum)) {
    warn("byte {}: tristimulus values want luminous flux and no spectrum", kFlags);
  }
}

void Tm25Opener::read_texts() {
  std::vector<std::uint32_t> codes(kTextCodes);
  for (std::size_t t = 0; t < kTextFields.size(); ++t) {
    std::memcpy(codes.data(), head_.data() + kTexts + t * 4 * kTextCodes, 4 * kTextCodes);
    facts_.header.texts.*kTextFields[t] = utf8_from_utf32(codes);
  }
}

void Tm25Opener::read_spectra() {
  const std::uint64_t tables = count(kTableCount, kMaxSpectralPairs, "spectral tables");
  std::uint64_t at = kHeaderSize, pairs = 0;
  for (std::uint64_t t = 0; t < tables; ++t) {
    std::array<std::byte, 4> word{};
    file_.read_at(at, word);
    const auto n = load<std::int32_t>(word, 0);
    pairs += n < 0 ? 0 : static_cast<std::uint64_t>(n);
    if (n < 0 || pairs > kMaxSpectralPairs)
      fail(at, "{} pairs in spectral table {}, 0 to {} expected", n, t + 1, kMaxSpectralPairs);
    if (static_cast<std::uint64_t>(n) > (file_.size() - at - 4) / 8) {
      fail(at, "{} pairs in spectral table {} expected, but the file ends at byte {}", n, t + 1,
           file_.size());
    }
    std::vector<std::byte> bytes(8 * static_cast<std::size_t>(n));
    file_.read_at(at + 4, bytes);
    SpectralTable table;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      table.wavelength_nm.push_back(load<float>(bytes, 8 * i));
      table.relative_power.push_back(load<float>(bytes, 8 * i + 4));
      const bool ascends = i == 0 || table.wavelength_nm[i] > table.wavelength_nm[i - 1];
      if (!std::isfinite(table.wavelength_nm[i]) || !ascends || !(table.relative_power[i] >= 0.0F) ||
          !std::isfinite(table.relative_power[i])) {
        fail(at + 4 + 8 * i,
             "spectral table {}: ({}, {}) found, ascending wavelengths and weights >= 0 expected", t + 1,
             table.wavelength_nm[i], table.relative_power[i]);
      }
    }
    facts_.header.spectra.push_back(std::move(table));
    at += 4 + bytes.size();
  }
  tables_end_ = at;
  const auto spectral = load<std::int32_t>(head_, kSpectralId);
  if ((spectral == one_table && tables != 1) || (spectral == table_per_ray && tables == 0)) {
    warn("byte {}: spectral identifier {} with {} spectral tables", kTableCount, spectral, tables);
  }
}

void Tm25Opener::read_labels() {
  const std::uint64_t items = count(kItemCount, kMaxItems, "additional items per ray");
  const std::uint64_t text_bytes = count(kTextSize, kMaxTextBytes, "bytes of additional text");
  after_tables_ = items * 4 * kLabelCodes + text_bytes;
  const std::uint64_t start = padded(tables_end_);
  if (start > file_.size() || after_tables_ > file_.size() - start) {
    fail(kTextSize, "labels and text of {} bytes expected from byte {}, the file ends at byte {}",
         after_tables_, start, file_.size());
  }
  const auto text_at = [&](std::uint64_t offset, std::uint64_t bytes) {
    std::vector<std::uint32_t> codes(bytes / 4);
    file_.read_at(offset, std::as_writable_bytes(std::span(codes)));
    return utf8_from_utf32(codes);
  };
  for (std::uint64_t a = 0; a < items; ++a)
    labels_.push_back(text_at(start + a * 4 * kLabelCodes, 4 * kLabelCodes));
  facts_.header.texts.additional_text = text_at(start + items * 4 * kLabelCodes, text_bytes);
  if (text_bytes % kPad != 0)
    warn("byte {}: additional text of {} bytes, a multiple of 32 expected", kTextSize, text_bytes);
}

void Tm25Opener::add_column(ColumnKind kind, std::size_t n) {
  facts_.header.columns.push_back({kind, standard_label(kind, n)});
  layout_.extra.push_back({static_cast<int>(layout_.floats++)});
}

void Tm25Opener::make_columns() {
  RaySetHeader& header = facts_.header;
  const bool both = flag_[radiant] && flag_[luminous];
  const bool lumen = flag_[luminous] && !(both && header.flux_w && !header.flux_lm);
  header.flux_unit = lumen ? FluxUnit::lumen : FluxUnit::watt;
  layout_.floats = 6;
  const auto flux = [&](bool is_weight, ColumnKind kind) {
    if (is_weight) {
      layout_.main[6].at = static_cast<int>(layout_.floats++);
    } else {
      add_column(kind);
    }
  };
  if (flag_[radiant]) flux(!lumen, ColumnKind::radiant_flux_w);
  if (flag_[wavelength]) add_column(ColumnKind::wavelength_nm);
  if (flag_[luminous]) flux(lumen, ColumnKind::luminous_flux_lm);
  for (std::size_t s = 0; flag_[stokes] && s < 6; ++s) add_column(ColumnKind::stokes, s);
  if (flag_[tristimulus]) add_column(ColumnKind::tristimulus_x);
  if (flag_[tristimulus]) add_column(ColumnKind::tristimulus_z);
  if (flag_[spectrum_index]) {
    add_column(ColumnKind::spectrum_index);
    layout_.extra.back().integers_up_to = static_cast<std::uint32_t>(header.spectra.size());
  }
  for (const std::string& label : labels_) {
    add_column(ColumnKind::additional);
    header.columns.back().label = label;
  }
}

/// Takes the last three Stokes columns (the axis of the ellipse) out: some writers leave them out.
void Tm25Opener::set_stokes(std::size_t columns) {
  const std::size_t first = *find_column(facts_.header.columns, ColumnKind::stokes);
  for (std::size_t gone = 6; gone > columns; --gone) {
    const auto at = static_cast<std::ptrdiff_t>(first + gone - 1);
    facts_.header.columns.erase(facts_.header.columns.begin() + at);
    layout_.extra.erase(layout_.extra.begin() + at);
    for (std::size_t c = static_cast<std::size_t>(at); c < layout_.extra.size(); ++c) --layout_.extra[c].at;
    --layout_.floats;
  }
}

bool Tm25Opener::plausible(std::uint64_t start) const {
  const std::uint64_t n = std::min(kTm25Probe, facts_.ray_count);
  const std::vector<float> records = peek_records(file_, start, layout_.floats, n);
  if (records.size() < n * layout_.floats) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const float* r = records.data() + i * layout_.floats;
    const double square = dot(Vec3{r[3], r[4], r[5]}, Vec3{r[3], r[4], r[5]});
    if (!(std::abs(square - 1.0) <= kDirectionTolerance)) return false;
  }
  return true;
}

/// Finds where the rays begin: by the header's arithmetic if that meets the end of the file; else anchored to
/// the end of the file, if the padding can explain it and the directions say so too (a file cut short must
/// not pass for one).
void Tm25Opener::place_rays() {
  const std::uint64_t computed = padded(tables_end_) + after_tables_, shortest = tables_end_ + after_tables_;
  const std::uint64_t n = facts_.ray_count;
  const auto anchored = [&]() -> std::optional<std::uint64_t> {
    if (n > file_.size() / layout_.record_bytes()) return std::nullopt;
    return file_.size() - n * layout_.record_bytes();
  };
  const auto begin_at = [&](std::uint64_t start) { layout_.first_byte = start; };
  if (anchored() == computed) return begin_at(computed);
  if (flag_[stokes] && n > 0) {
    const RayFileFacts facts = facts_;
    const RecordLayout layout = layout_;
    set_stokes(3);
    if (anchored() == computed) {
      warn("Stokes vectors of 3 numbers, without the axis of the ellipse");
      return begin_at(computed);
    }
    facts_ = facts;
    layout_ = layout;
  }
  const auto start = anchored();
  if (n > 0 && start && *start >= shortest && *start <= computed + 2 * kPad && !plausible(computed) &&
      plausible(*start)) {
    warn("byte {}: the rays begin here as seen from the end of the file; byte {} expected from the header",
         *start, computed);
    return begin_at(*start);
  }
  if (start && *start > computed && plausible(computed)) {
    warn("byte {}: {} bytes after the last ray", computed + n * layout_.record_bytes(), *start - computed);
    return begin_at(computed);
  }
  if (!options_.salvage) require_records(file_, n, kRayCount, computed, layout_.record_bytes());
  if (!plausible(computed) && !options_.salvage) {
    fail(computed, "unit directions expected in the first rays of {} numbers, others found", layout_.floats);
  }
  facts_.ray_count =
      whole_records(file_, n, kRayCount, computed, layout_.record_bytes(), options_.salvage, facts_.warnings);
  begin_at(computed);
}

}  // namespace

bool looks_like_tm25(const InputFile& file) {
  std::string magic(4, '\0');
  if (file.size() < magic.size()) return false;
  file.read_at(0, std::as_writable_bytes(std::span(magic)));
  return magic == "TM25";
}

std::unique_ptr<RayReader> open_tm25(InputFile file, const ReadOptions& options) {
  return Tm25Opener(std::move(file), options).open();
}

}  // namespace lucerna
