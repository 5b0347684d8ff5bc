// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/rays.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Rays per block that readers and writers of large files use: a few MB, so that it stays in the cache.
inline constexpr std::size_t kStreamBlock = 1 << 16;

/// How a ray file is to be read.
struct ReadOptions {
  /// Take what is whole of a damaged file: whole rays of a truncated one, all but the faulty rays; warnings
  /// say so.
  bool salvage = false;
  /// A format's name to read the file as; empty = found from the content.
  std::string format = {};
  /// For format "text": what each column of a line holds, x, y, z (with _mm, _cm, _m, _inch), kx, ky, kz,
  /// flux (flux_lm, flux_w), wavelength_nm; "-" leaves one out, any other name makes an additional column;
  /// empty = as the file declares.
  std::vector<std::string> text_columns = {};
};

/// How a ray file is to be written.
struct WriteOptions {
  /// Unit of lengths in the file, as RayReader::length_unit names them; formats without a choice take "mm"
  /// only.
  std::string length_unit = "mm";
};

/// A ray file being read from front to back, block by block; memory does not grow with the file.
/// Every format's reader implements this. Not thread safe.
class RayReader {
 public:
  virtual ~RayReader() = default;

  /// All that the file says beside its rays.
  const RaySetHeader& header() const { return header_; }
  /// Rays in the file, known before the first is read. With ReadOptions::salvage faulty rays among them are
  /// left out as they are met, so that fewer may come.
  std::uint64_t ray_count() const { return ray_count_; }
  /// One of `ray_formats()`: "tm25", "zemax-binary", ...
  const std::string& format() const { return format_; }
  /// The file's name as it was given, for messages.
  const std::string& name() const { return name_; }
  /// The unit that the file has its lengths in ("mm", "inch", ...); what `read` returns is always mm.
  const std::string& length_unit() const { return length_unit_; }
  /// What was odd but could be read; each names its place. Grows while rays are read.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Rays left out so far because they were faulty; only with ReadOptions::salvage.
  std::uint64_t dropped() const { return dropped_; }

  /// Replaces `block` by the next at most `max_rays` > 0 rays; returns how many (0 at the end and only
  /// there). Every start, direction and weight is finite, every direction is unit to 1e-3 and then normalised
  /// (directions whose square is 1 to 1e-6, which float32 can hold, keep their bits), every weight >= 0;
  /// else InputError with the ray's number (from 0) and its byte or line. Extra columns are finite but for
  /// Stokes and additional ones.
  [[nodiscard]] virtual std::size_t read(RayBlock& block, std::size_t max_rays) = 0;

  /// Passes over the next `rays` rays, not beyond the end. Binary formats but MCPL take no time for it and do
  /// not look at what they pass over, so that no fault in it is found; the others read it.
  virtual void skip(std::uint64_t rays);

 protected:
  RaySetHeader header_;
  std::uint64_t ray_count_ = 0, dropped_ = 0;
  std::string format_, name_, length_unit_ = "mm";
  std::vector<std::string> warnings_;
};

/// A ray file being written from front to back. The file appears under its name when `finish` returns. Not
/// thread safe.
class RayWriter {
 public:
  virtual ~RayWriter() = default;
  /// Appends a block whose extra columns are those of the header that the writer was made with.
  virtual void write(const RayBlock& block) = 0;
  /// Completes header and footer and renames the file. Call once, last.
  virtual void finish() = 0;
  /// What of the header or columns this format cannot hold, one sentence each; complete once `finish` has
  /// returned.
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  std::vector<std::string> warnings_;
};

/// The names of all formats, as `create_ray_file` and ReadOptions::format take them.
std::span<const std::string_view> ray_formats();

/// The usual ending of a format's files, with its dot. UsageError if it is no format.
std::string_view ray_file_ending(std::string_view format);

/// The format that the file's content says, never its name; absent if it is no ray file. InputError if it
/// cannot be read, is empty, or its content fits several formats (the text names them and the option that
/// decides).
[[nodiscard]] std::optional<std::string> detect_ray_format(const std::filesystem::path& path);

/// Opens a ray file for streaming. Throws InputError if it cannot be read, is no ray file, or its header does
/// not add up; UsageError if `options.format` is no format.
[[nodiscard]] std::unique_ptr<RayReader> open_ray_file(const std::filesystem::path& path,
                                                       const ReadOptions& options = {});

/// Starts a ray file. `ray_count` is what the caller means to write; the count in the file is what was
/// written. Throws UsageError if `format` is no format, InputError if the place cannot be written.
[[nodiscard]] std::unique_ptr<RayWriter> create_ray_file(const std::filesystem::path& path,
                                                         std::string_view format, const RaySetHeader& header,
                                                         std::uint64_t ray_count,
                                                         const WriteOptions& options = {});

/// The format to write `path` in: `to` if not empty, else what the ending says ("tm25ray", "sdf", "dis",
/// "mcpl"). Throws UsageError if it is no format, or if the ending could mean several or none.
[[nodiscard]] std::string ray_format_for(const std::filesystem::path& path, std::string_view to = {});

/// The whole file in memory. `warnings`, if given, gets the reader's.
[[nodiscard]] RaySet read_ray_set(const std::filesystem::path& path, const ReadOptions& options = {},
                                  Progress& progress = no_progress(),
                                  std::vector<std::string>* warnings = nullptr);

/// Writes all of `set`; returns the writer's warnings.
std::vector<std::string> write_ray_set(const std::filesystem::path& path, const RaySet& set,
                                       std::string_view format, const WriteOptions& options = {});

/// Calls `use(block)` for the rest of the rays, in blocks of kStreamBlock, with progress under `phase`.
template <class Use>
void for_each_block(RayReader& reader, Progress& progress, std::string_view phase, const Use& use) {
  RayBlock block;
  std::uint64_t done = 0;
  while (const std::size_t n = reader.read(block, kStreamBlock)) {
    use(static_cast<const RayBlock&>(block));
    progress.step(phase, done += n, reader.ray_count());
  }
}

/// The file's total flux in its unit; throws InputError if the file does not state one.
double require_flux(const RaySetHeader& header, std::string_view name);

}  // namespace lucerna
#pragma GCC visibility pop
