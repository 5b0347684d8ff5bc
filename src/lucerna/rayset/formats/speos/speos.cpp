// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/speos/speos.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"

namespace lucerna {

namespace {

constexpr std::size_t kWatts = 0, kVersion = 4, kVersions = 5, kLumens = 24, kSpeosHeaderSize = 28;
constexpr std::size_t kPlain = 8, kPolarised = 13;
/// Rays whose directions say which of the two a file has.
constexpr std::size_t kRaysLookedAt = 64;

class SpeosWriter final : public RayWriter {
 public:
  SpeosWriter(const std::filesystem::path& path, const RaySetHeader& header)
      : wavelengths_(header, writes_lumens(header) ? FluxUnit::lumen : FluxUnit::watt, kGreen_nm),
        writer_(path, layout_for(header)) {
    if (std::string warning = wavelengths_warning(wavelengths_); !warning.empty())
      warnings_.push_back(std::move(warning));
    for (std::string& lost : losses(
             header, "speos", {.wavelengths = true, .one_wavelength = true, .table = true, .texts = false}))
      warnings_.push_back(std::move(lost));
    const bool lumen_only = writes_lumens(header);
    if (lumen_only)
      warnings_.push_back("speos energies are meant in watt; the lumens of the rays are written");
    std::vector<std::byte> head(kSpeosHeaderSize);
    store(head, kWatts, lumen_only ? 0.0F : static_cast<float>(header.flux_w.value_or(0.0)));
    for (std::size_t v = 0; v < kVersions; ++v) store(head, kVersion + 4 * v, 2.0F);
    store(head, kLumens, static_cast<float>(header.flux_lm.value_or(0.0)));
    writer_.write_bytes(head);
  }

  void write(const RayBlock& block) override {
    if (wavelengths_.column()) return writer_.write_rays(block);
    RayBlock with = block;
    with.extra.emplace_back(block.size());
    for (std::size_t i = 0; i < block.size(); ++i)
      with.extra.back()[i] = wavelengths_.of(block, i, writer_.ray_count() + i);
    writer_.write_rays(with);
  }

  void finish() override { writer_.file().commit(); }

 private:
  /// Lumen weights with a wavelength each are no watts: then only the lumens may be stated.
  static bool writes_lumens(const RaySetHeader& header) {
    return header.flux_unit == FluxUnit::lumen &&
           (find_column(header.columns, ColumnKind::wavelength_nm) || !header.flux_w);
  }
  RecordLayout layout_for(const RaySetHeader& header) const {
    RecordLayout layout;
    layout.floats = kPlain;
    layout.main[6].at = 7;
    layout.extra.assign(header.columns.size() + (wavelengths_.column() ? 0 : 1), RecordColumn{});
    layout.extra[wavelengths_.column().value_or(header.columns.size())].at = 6;
    return layout;
  }

  RayWavelengths wavelengths_;
  RecordWriter writer_;
};

/// How many of the first rays have directions of length 1 if a record is so many numbers long.
std::size_t unit_directions(std::span<const float> numbers, std::size_t record, std::size_t rays) {
  std::size_t found = 0;
  for (std::size_t ray = 0; ray < rays; ++ray) {
    const auto k = numbers.subspan(ray * record + 3, 3);
    found += std::abs(std::hypot(k[0], k[1], k[2]) - 1.0F) < 0.01F ? 1 : 0;
  }
  return found;
}

/// Nothing in the header says whether rays have a polarisation. Sizes do not decide it of a file that is cut:
/// the first directions do, and the size only where they fit both.
std::size_t numbers_per_ray(const InputFile& file, std::uint64_t bytes) {
  const std::size_t rays = std::min<std::uint64_t>(kRaysLookedAt, bytes / (4 * kPolarised));
  std::vector<float> numbers(rays * kPolarised);
  file.read_at(kSpeosHeaderSize, std::as_writable_bytes(std::span(numbers)));
  const std::size_t plain = unit_directions(numbers, kPlain, rays),
                    polarised = unit_directions(numbers, kPolarised, rays);
  if (plain != polarised) return polarised > plain ? kPolarised : kPlain;
  return bytes % (4 * kPlain) != 0 && bytes % (4 * kPolarised) == 0 ? kPolarised : kPlain;
}

}  // namespace

bool looks_like_speos(const InputFile& file) {
  if (file.size() < kSpeosHeaderSize) return false;
  std::array<std::byte, kSpeosHeaderSize> head{};
  file.read_at(0, head);
  const auto version = load<float>(head, kVersion);
  for (std::size_t v = 1; v < kVersions; ++v) {
    if (load<float>(head, kVersion + 4 * v) != version) return false;
  }
  const auto watts = load<float>(head, kWatts), lumens = load<float>(head, kLumens);
  return version >= 1.0F && version <= 100.0F && std::isfinite(watts) && watts >= 0.0F &&
         std::isfinite(lumens) && lumens >= 0.0F;
}

std::unique_ptr<RayReader> open_speos(InputFile file, const ReadOptions& options) {
  std::vector<std::byte> head(kSpeosHeaderSize);
  file.read_at(0, head);
  if (!looks_like_speos(file)) {
    throw_input_error(file.name(), fmt::format("byte {}", kVersion),
                      "five equal version numbers expected, others found");
  }
  RayFileFacts facts;
  facts.format = "speos";
  const auto version = load<float>(head, kVersion);
  if (version != 2.0F)
    facts.warnings.push_back(fmt::format("byte {}: version {} found, 2 expected", kVersion, version));
  const auto watts = load<float>(head, kWatts), lumens = load<float>(head, kLumens);
  if (watts > 0.0F) facts.header.flux_w = static_cast<double>(watts);
  if (lumens > 0.0F) facts.header.flux_lm = static_cast<double>(lumens);
  facts.header.flux_unit = watts > 0.0F || !(lumens > 0.0F) ? FluxUnit::watt : FluxUnit::lumen;
  facts.header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  RecordLayout layout;
  layout.first_byte = kSpeosHeaderSize;
  layout.main[6].at = 7;
  layout.extra = {{6}};
  const std::uint64_t bytes = file.size() - kSpeosHeaderSize;
  layout.floats = numbers_per_ray(file, bytes);
  if (layout.floats == kPolarised) {
    for (const char* label : {"ellipse o", "ellipse p", "ellipse q", "ellipse axis ratio", "handedness"}) {
      layout.extra.push_back({static_cast<int>(kPlain + facts.header.columns.size() - 1)});
      facts.header.columns.push_back({ColumnKind::additional, label});
    }
  }
  facts.ray_count = bytes / layout.record_bytes();
  if (const std::uint64_t over = bytes % layout.record_bytes(); over != 0) {
    const std::string what =
        fmt::format("whole rays of {} bytes expected; the file ends after {} rays and {} bytes",
                    layout.record_bytes(), facts.ray_count, over);
    if (!options.salvage)
      throw_input_error_for("salvage", file.name(), fmt::format("byte {}", file.size()), "{}", what);
    facts.warnings.push_back(fmt::format("byte {}: {}: the whole ones are read", file.size(), what));
  }
  return std::make_unique<RecordReader>(std::move(file), std::move(facts), std::move(layout),
                                        options.salvage);
}

std::unique_ptr<RayWriter> create_speos(const std::filesystem::path& path, const RaySetHeader& header,
                                        const WriteOptions& options) {
  if (options.length_unit != "mm")
    throw UsageError(fmt::format("speos: lengths are mm, not {}", options.length_unit));
  return std::make_unique<SpeosWriter>(path, header);
}

}  // namespace lucerna
