// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/formats/common/ray_fault.h"

/// What the binary formats share: after a header come records of little-endian float32, one per ray. A
/// format's own file only turns its header into a RecordLayout, and back.
namespace lucerna {

/// Where one array of a RayBlock is found in a record.
struct RecordColumn {
  /// Which float32 of the record; negative = not stored: zero is read (starts of far-field files).
  int at = -1;
  /// Stored value times this, plus `offset`, is ours (lengths to mm, micrometres to nm, a data origin).
  double scale = 1.0, offset = 0.0;
  /// Some writers store this number as an int32: bit patterns from 1 to this are taken as one (0 = never).
  std::uint32_t integers_up_to = 0;
};

/// How the rays lie in a file.
struct RecordLayout {
  std::uint64_t first_byte = 0;
  /// float32 per ray.
  std::size_t floats = 7;
  /// x, y, z, kx, ky, kz, weight.
  std::array<RecordColumn, 7> main{{{0}, {1}, {2}, {3}, {4}, {5}, {6}}};
  /// One for each entry of RaySetHeader::columns.
  std::vector<RecordColumn> extra;

  std::size_t record_bytes() const { return 4 * floats; }
  /// Multiplies the starts by `mm_per_unit`.
  void scale_lengths(double mm_per_unit) {
    for (std::size_t c = 0; c < 3; ++c) main[c].scale = mm_per_unit;
  }
};

/// Millimetres in a unit of RayReader::length_unit: "um", "mm", "cm", "m", "inch", "feet"; absent if it is
/// none of them.
std::optional<double> mm_per(std::string_view unit);

/// The layout to write a block of `header` in: place, direction and flux, lengths in `length_unit` (one that
/// mm_per knows); with a `wavelength_scale` above 0 wavelengths follow, in nm divided by it, if the header
/// has them.
RecordLayout written_layout(const RaySetHeader& header, std::string_view length_unit,
                            double wavelength_scale = 0.0);

/// All that a format's opener finds out before the first ray.
struct RayFileFacts {
  RaySetHeader header;
  std::uint64_t ray_count = 0;
  std::string format;
  std::string length_unit = "mm";
  std::vector<std::string> warnings;
};

/// Reads such a file: large reads, conversion and checks on all threads; the order of the rays is the file's.
/// Memory: a block's records beside the block.
class RecordReader final : public RayReader {
 public:
  /// The caller has checked that all `facts.ray_count` records lie inside `file`.
  RecordReader(InputFile file, RayFileFacts facts, RecordLayout layout, bool salvage);
  std::size_t read(RayBlock& block, std::size_t max_rays) override;
  void skip(std::uint64_t rays) override { next_ += std::min(rays, ray_count_ - next_); }

 private:
  [[noreturn]] void fail(const RayFault& fault) const;
  std::optional<RayFault> read_part(RayBlock& block, std::size_t first, std::size_t last) const;

  InputFile file_;
  RecordLayout layout_;
  std::uint64_t next_ = 0;
  bool salvage_;
};

/// Writes the records of such a file; the format's own writer holds one and adds header and footer.
class RecordWriter {
 public:
  RecordWriter(const std::filesystem::path& path, RecordLayout layout);

  /// Appends bytes that are not rays.
  void write_bytes(std::span<const std::byte> bytes) { file_.write(bytes); }
  void write_rays(const RayBlock& block);
  std::uint64_t ray_count() const { return count_; }
  OutputFile& file() { return file_; }

 private:
  OutputFile file_;
  RecordLayout layout_;
  std::vector<float> records_;
  std::uint64_t count_ = 0;
};

/// The first at most `count` rays as they lie in the file, unchecked, for an opener that must look at some;
/// fewer where the file ends.
std::vector<float> peek_records(const InputFile& file, std::uint64_t first_byte, std::size_t floats,
                                std::uint64_t count);

/// What a format can hold beside starts, directions and one flux.
struct FormatHolds {
  bool wavelengths = false;
  /// One wavelength for all rays, or a table turned into one wavelength per ray.
  bool one_wavelength = false, table = false;
  /// The light source's name; all texts.
  bool source_name = false, texts = false;
};

/// One sentence for each thing of `header` that a format of these abilities loses.
std::vector<std::string> losses(const RaySetHeader& header, std::string_view format,
                                const FormatHolds& holds);

/// Whole rays in the file from `first_byte`, at most `announced`. If there are fewer than announced:
/// InputError as from require_records, or with `salvage` a warning. More bytes than rays: a warning.
std::uint64_t whole_records(const InputFile& file, std::uint64_t announced, std::uint64_t count_byte,
                            std::uint64_t first_byte, std::uint64_t record_bytes, bool salvage,
                            std::vector<std::string>& warnings);

/// Throws InputError unless `count` records of `record_bytes` fit between `first_byte` and the end of `file`;
/// the text names the byte where the count stands. Safe for any count.
void require_records(const InputFile& file, std::uint64_t count, std::uint64_t count_byte,
                     std::uint64_t first_byte, std::uint64_t record_bytes);

}  // namespace lucerna
