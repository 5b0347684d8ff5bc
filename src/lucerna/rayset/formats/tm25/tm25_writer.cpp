// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"
#include "lucerna/rayset/formats/tm25/tm25.h"
#include "lucerna/rayset/formats/tm25/tm25_layout.h"
#include "lucerna/rayset/formats/tm25/utf32.h"

namespace lucerna {

using namespace tm25;

namespace {

constexpr float kNotDeclared = std::numeric_limits<float>::quiet_NaN();

/// Where each column of the header goes in a record, and the flags that say so.
struct Tm25Columns {
  std::array<bool, flag_count> flag{};
  RecordLayout layout;
  std::vector<std::string> labels;  // of the additional items
};

std::vector<std::size_t> of_kind(const RaySetHeader& header, ColumnKind kind) {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < header.columns.size(); ++c) {
    if (header.columns[c].kind == kind) found.push_back(c);
  }
  return found;
}

/// Puts the columns into the order of the standard. What it has no place for (a second wavelength, X without
/// Z, a Stokes vector of neither 3 nor 6 numbers) becomes an additional item.
Tm25Columns arrange(const RaySetHeader& header, std::vector<std::string>& warnings) {
  Tm25Columns out;
  out.flag[position] = out.flag[direction] = true;
  out.layout.floats = 6;
  out.layout.extra.assign(header.columns.size(), RecordColumn{});
  std::vector<bool> placed(header.columns.size(), false);
  const auto place = [&](std::size_t column) {
    out.layout.extra[column].at = static_cast<int>(out.layout.floats++);
    placed[column] = true;
  };
  const auto place_first = [&](ColumnKind kind, Flag flag) {
    if (const auto column = find_column(header.columns, kind)) place(*column), out.flag[flag] = true;
  };
  const auto place_flux = [&](FluxUnit unit, ColumnKind kind, Flag flag) {
    if (header.flux_unit != unit) return place_first(kind, flag);
    out.layout.main[6].at = static_cast<int>(out.layout.floats++);
    out.flag[flag] = true;
  };
  place_flux(FluxUnit::watt, ColumnKind::radiant_flux_w, radiant);
  place_first(ColumnKind::wavelength_nm, wavelength);
  place_flux(FluxUnit::lumen, ColumnKind::luminous_flux_lm, luminous);
  if (const auto columns = of_kind(header, ColumnKind::stokes); columns.size() == 3 || columns.size() == 6) {
    std::ranges::for_each(columns, place);
    out.flag[stokes] = true;
  }
  const auto x = find_column(header.columns, ColumnKind::tristimulus_x),
             z = find_column(header.columns, ColumnKind::tristimulus_z);
  if (x && z) place(*x), place(*z), out.flag[tristimulus] = true;
  place_first(ColumnKind::spectrum_index, spectrum_index);
  for (std::size_t c = 0; c < header.columns.size(); ++c) {
    if (placed[c]) continue;
    place(c);
    out.labels.push_back(header.columns[c].label);
    if (header.columns[c].kind != ColumnKind::additional) {
      warnings.push_back(
          fmt::format("column '{}' is written as an additional item: TM-25 has no other place for it",
                      header.columns[c].label));
    }
  }
  return out;
}

class Tm25Writer final : public RayWriter {
 public:
  Tm25Writer(const std::filesystem::path& path, const RaySetHeader& header)
      : columns_(arrange(header, warnings_)),
        wavelength_column_(find_column(header.columns, ColumnKind::wavelength_nm)),
        writer_(path, columns_.layout) {
    write_header(header);
  }

  void write(const RayBlock& block) override {
    if (wavelength_column_ && *wavelength_column_ < block.extra.size()) {
      for (const float w : block.extra[*wavelength_column_]) {
        shortest_ = std::min(shortest_, w);
        longest_ = std::max(longest_, w);
      }
    }
    writer_.write_rays(block);
  }

  void finish() override {
    const auto put = [&](std::size_t offset, auto value) {
      writer_.file().patch(offset, std::as_bytes(std::span(&value, 1)));
    };
    put(kRayCount, writer_.ray_count());
    if (shortest_ <= longest_) {
      put(kMinWavelength, shortest_);
      put(kMaxWavelength, longest_);
    }
    writer_.file().commit();
  }

 private:
  void write_header(const RaySetHeader& header);
  void write_spectra(const std::vector<SpectralTable>& spectra);
  void write_labels_and_text(const std::vector<std::uint32_t>& text);
  /// `text` as `size` code points, the last of them zero.
  std::vector<std::uint32_t> field(const std::string& text, std::size_t size, const std::string& name);
  int spectral_id(const RaySetHeader& header);

  Tm25Columns columns_;
  std::optional<std::size_t> wavelength_column_;
  RecordWriter writer_;
  float shortest_ = std::numeric_limits<float>::max(), longest_ = std::numeric_limits<float>::lowest();
};

std::vector<std::uint32_t> Tm25Writer::field(const std::string& text, std::size_t size,
                                             const std::string& name) {
  std::vector<std::uint32_t> codes = utf32_from_utf8(text);
  if (codes.size() >= size) warnings_.push_back(fmt::format("{}: cut to {} characters", name, size - 1));
  codes.resize(std::min(codes.size(), size - 1));
  codes.resize(size, 0);
  return codes;
}

int Tm25Writer::spectral_id(const RaySetHeader& header) {
  const bool index = columns_.flag[spectrum_index], per_ray = columns_.flag[wavelength];
  if ((index || per_ray) && header.flux_unit == FluxUnit::lumen) {
    warnings_.push_back("rays with spectra of their own carry lumen here; TM-25 wants watt for them");
  }
  if (index) return table_per_ray;
  if (per_ray) return wavelength_per_ray;
  if (!header.spectra.empty()) return one_table;
  return header.wavelength_nm ? one_wavelength : no_spectrum;
}

void Tm25Writer::write_header(const RaySetHeader& header) {
  const std::vector<std::uint32_t> text = utf32_from_utf8(header.texts.additional_text);
  std::vector<std::byte> head(kHeaderSize);
  std::memcpy(head.data(), "TM25", 4);
  store(head, kVersion, std::int32_t{2013});
  store(head, kCreationMethod, static_cast<std::int32_t>(header.creation_method));
  store(head, kFluxLm, header.flux_lm ? static_cast<float>(*header.flux_lm) : kNotDeclared);
  store(head, kFluxW, header.flux_w ? static_cast<float>(*header.flux_w) : kNotDeclared);
  if (header.texts.date.size() >= kDateSize) warnings_.push_back("date: cut to 27 characters");
  store_text(head, kDate, kDateSize, header.texts.date);
  store(head, kStartPosition, static_cast<std::int32_t>(header.start_position));
  const int id = spectral_id(header);
  store(head, kSpectralId, static_cast<std::int32_t>(id));
  store(head, kWavelength, id == one_wavelength ? *header.wavelength_nm : kNotDeclared);
  float shortest = kNotDeclared, longest = kNotDeclared;
  for (const SpectralTable& table : header.spectra) {
    if (table.wavelength_nm.empty()) continue;
    shortest = std::fmin(shortest, table.wavelength_nm.front());
    longest = std::fmax(longest, table.wavelength_nm.back());
  }
  store(head, kMinWavelength, shortest);
  store(head, kMaxWavelength, longest);
  store(head, kTableCount, static_cast<std::int32_t>(header.spectra.size()));
  store(head, kItemCount, static_cast<std::int32_t>(columns_.labels.size()));
  store(head, kTextSize, static_cast<std::int32_t>(padded(4 * text.size())));
  for (std::size_t f = 0; f < flag_count; ++f)
    store(head, kFlags + 4 * f, static_cast<std::int32_t>(columns_.flag[f]));
  for (std::size_t t = 0; t < kTextFields.size(); ++t) {
    const auto codes = field(header.texts.*kTextFields[t], kTextCodes, fmt::format("text {}", t + 1));
    std::memcpy(head.data() + kTexts + t * 4 * kTextCodes, codes.data(), 4 * kTextCodes);
  }
  writer_.write_bytes(head);
  write_spectra(header.spectra);
  write_labels_and_text(text);
}

void Tm25Writer::write_spectra(const std::vector<SpectralTable>& spectra) {
  std::vector<std::byte> bytes;
  for (const SpectralTable& table : spectra) {
    const std::size_t at = bytes.size(), n = table.wavelength_nm.size();
    LUCERNA_CHECK(table.relative_power.size() == n, "{} and {} numbers", n, table.relative_power.size());
    bytes.resize(at + 4 + 8 * n);
    store(bytes, at, static_cast<std::int32_t>(n));
    for (std::size_t i = 0; i < n; ++i) {
      store(bytes, at + 4 + 8 * i, table.wavelength_nm[i]);
      store(bytes, at + 8 + 8 * i, table.relative_power[i]);
    }
  }
  bytes.resize(padded(bytes.size()));
  writer_.write_bytes(bytes);
}

void Tm25Writer::write_labels_and_text(const std::vector<std::uint32_t>& text) {
  for (const std::string& label : columns_.labels) {
    const auto codes = field(label, kLabelCodes, fmt::format("label '{}'", label));
    writer_.write_bytes(std::as_bytes(std::span(codes)));
  }
  std::vector<std::uint32_t> codes = text;
  codes.resize(padded(4 * text.size()) / 4, 0);
  writer_.write_bytes(std::as_bytes(std::span(codes)));
}

}  // namespace

std::unique_ptr<RayWriter> create_tm25(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options) {
  if (options.length_unit != "mm")
    throw UsageError(fmt::format("tm25: lengths are mm, not {}", options.length_unit));
  return std::make_unique<Tm25Writer>(path, header);
}

}  // namespace lucerna
