// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/asap/asap.h"

#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"

namespace lucerna {

namespace {

constexpr std::int32_t kCode = 247, kCodeStep = 1024;
constexpr std::size_t kMinWords = 7, kMaxWords = 64, kHeaderRecords = 5, kNameSize = 8, kLabelSize = 16;
constexpr std::string_view kFluxName = "Tot Flux", kLetters = "XYZABCF";
struct AsapUnit {
  std::string_view name, label;
};
constexpr std::array<AsapUnit, 4> kAsapUnits{{{"mm", "MM"}, {"cm", "CM"}, {"m", "M"}, {"inch", "INCH"}}};

/// Words per record from the first word; 0 if it is none of ours.
std::size_t words_from(std::int32_t code) {
  if (code < kCode || (code - kCode) % kCodeStep != 0) return 0;
  const auto words = static_cast<std::size_t>((code - kCode) / kCodeStep);
  return words >= kMinWords && words <= kMaxWords ? words : 0;
}

std::size_t words_of(const InputFile& file) {
  std::array<std::byte, 4> word{};
  if (file.size() < word.size()) return 0;
  file.read_at(0, word);
  return words_from(load<std::int32_t>(word, 0));
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c != ' ') {
      parts.back() += c;
    } else if (!parts.back().empty()) {
      parts.emplace_back();
    }
  }
  if (parts.back().empty()) parts.pop_back();
  return parts;
}

/// Columns and units from the field label, "XYZABCF MM LM".
RecordLayout layout_from(const std::string& label, std::size_t words, const InputFile& file,
                         RayFileFacts& facts) {
  const std::size_t place = 8 * words + kNameSize + 4;
  const auto parts = split(label);
  const std::string letters = parts.empty() ? "" : parts[0];
  RecordLayout layout;
  layout.floats = words;
  layout.first_byte = kHeaderRecords * 4 * words;
  for (std::size_t c = 0; c < kLetters.size(); ++c) {
    const std::size_t at = letters.find(kLetters[c]);
    if (at == std::string::npos || at >= words) {
      throw_input_error(file.name(), fmt::format("byte {}", place), "columns '{}' found, each of {} expected",
                        letters, kLetters);
    }
    layout.main[c].at = static_cast<int>(at);
  }
  const std::string unit = parts.size() > 1 ? parts[1] : "";
  const auto known = std::ranges::find(kAsapUnits, unit, &AsapUnit::label);
  if (known == kAsapUnits.end()) {
    throw_input_error(file.name(), fmt::format("byte {}", place),
                      "length unit '{}' found, MM, CM, M or INCH expected", unit);
  }
  facts.length_unit = known->name;
  layout.scale_lengths(*mm_per(known->name));
  const std::string flux = parts.size() > 2 ? parts[2] : "";
  facts.header.flux_unit = flux.starts_with('W') ? FluxUnit::watt : FluxUnit::lumen;
  if (!flux.starts_with('W') && !flux.starts_with('L')) {
    facts.warnings.push_back(fmt::format("byte {}: the file does not say lm or W: lm is assumed", place));
  }
  for (std::size_t w = 0; w < words; ++w) {
    if (w < letters.size() && kLetters.find(letters[w]) != std::string::npos && letters.find(letters[w]) == w)
      continue;
    const std::string name =
        w < letters.size() ? std::string(1, letters[w]) : fmt::format("column {}", w + 1);
    facts.header.columns.push_back({ColumnKind::additional, name});
    layout.extra.push_back({static_cast<int>(w)});
  }
  return layout;
}

class AsapWriter final : public RayWriter {
 public:
  AsapWriter(const std::filesystem::path& path, const RaySetHeader& header, const WriteOptions& options)
      : writer_(path, layout_for(header, options)) {
    warnings_ = losses(header, "asap", {});
    constexpr std::size_t kRecord = 4 * kMinWords;
    std::vector<std::byte> head(kHeaderRecords * kRecord);
    const auto text = [&](std::size_t offset, std::size_t size, std::string_view value) {
      std::memset(head.data() + offset, ' ', size);
      std::memcpy(head.data() + offset, value.data(), std::min(size, value.size()));
    };
    store(head, 0, kCode + kCodeStep * static_cast<std::int32_t>(kMinWords));
    text(kRecord, 24, header.texts.light_source);
    text(2 * kRecord, kNameSize, kFluxName);
    store(head, 2 * kRecord + kNameSize, static_cast<float>(header.flux().value_or(0.0)));
    const auto unit = std::ranges::find(kAsapUnits, options.length_unit, &AsapUnit::name);
    text(2 * kRecord + kNameSize + 4, kLabelSize,
         fmt::format("{} {} {}", kLetters, unit->label, header.flux_unit == FluxUnit::lumen ? "LM" : "W"));
    text(kCountRecord, 16, "Ray number");
    store(head, kCountRecord + 16, 1.0F);
    text(4 * kRecord, 16, "Wavelength");
    store(head, 4 * kRecord + 24, std::int32_t{1});
    writer_.write_bytes(head);
  }

  void write(const RayBlock& block) override {
    writer_.write_rays(block);
    if (writer_.ray_count() > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max())) {
      throw InputError(fmt::format("{}: asap holds {} rays at most", writer_.file().path().string(),
                                   std::numeric_limits<std::int32_t>::max()));
    }
  }

  void finish() override {
    std::array<std::byte, 8> counts{};
    store(counts, 0, static_cast<float>(writer_.ray_count()));
    store(counts, 4, -static_cast<std::int32_t>(writer_.ray_count()));
    writer_.file().patch(kCountRecord + 20, counts);
    writer_.file().commit();
  }

 private:
  static constexpr std::size_t kCountRecord = 12 * kMinWords;

  static RecordLayout layout_for(const RaySetHeader& header, const WriteOptions& options) {
    if (std::ranges::find(kAsapUnits, options.length_unit, &AsapUnit::name) == kAsapUnits.end()) {
      throw UsageError(fmt::format("asap: lengths in mm, cm, m or inch, not {}", options.length_unit));
    }
    return written_layout(header, options.length_unit);
  }

  RecordWriter writer_;
};

}  // namespace

bool looks_like_asap(const InputFile& file) {
  const std::size_t words = words_of(file);
  if (words == 0 || file.size() < 8 * words + kNameSize) return false;
  std::string name(kNameSize, '\0');
  file.read_at(8 * words, std::as_writable_bytes(std::span(name)));
  return name == kFluxName;
}

std::unique_ptr<RayReader> open_asap(InputFile file, const ReadOptions& options) {
  const std::size_t words = words_of(file), record = 4 * words;
  if (words == 0)
    throw_input_error(file.name(), "byte 0",
                      "247 + 1024 LENR expected with LENR from 7 to 64, another number found");
  std::vector<std::byte> head(kHeaderRecords * record);
  file.read_at(0, head);
  RayFileFacts facts;
  facts.format = "asap";
  facts.header.texts.light_source = load_text(head, record, 24);
  RecordLayout layout =
      layout_from(load_text(head, 2 * record + kNameSize + 4, kLabelSize), words, file, facts);
  const auto flux = load<float>(head, 2 * record + kNameSize);
  if (std::isfinite(flux) && flux > 0.0F) facts.header.set_flux(static_cast<double>(flux));
  // The float beside it cannot hold every count.
  const std::size_t count_byte = 3 * record + 24;
  const auto negative = load<std::int32_t>(head, count_byte);
  if (negative > 0) {
    throw_input_error(file.name(), fmt::format("byte {}", count_byte),
                      "ray count {} found, a negative number expected", negative);
  }
  facts.ray_count = whole_records(file, static_cast<std::uint64_t>(-static_cast<std::int64_t>(negative)),
                                  count_byte, layout.first_byte, record, options.salvage, facts.warnings);
  return std::make_unique<RecordReader>(std::move(file), std::move(facts), std::move(layout),
                                        options.salvage);
}

std::unique_ptr<RayWriter> create_asap(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options) {
  return std::make_unique<AsapWriter>(path, header, options);
}

}  // namespace lucerna
