// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lucerna/rayset/ray_set.h"

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
  /// For format "text": what each column of a line holds (see text_rays.h); empty = as the file declares.
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

  const RaySetHeader& header() const { return header_; }
  /// Rays in the file, known before the first is read. With ReadOptions::salvage faulty rays among them are
  /// left out as they are met, so that fewer may come.
  std::uint64_t ray_count() const { return ray_count_; }
  /// The name that `--to` takes: "tm25", "zemax-binary", ...
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
  /// (directions that are unit to 1e-6, which is what float32 can hold, keep their bits), every weight >= 0;
  /// else InputError with the ray's number (from 0) and its byte or line. Extra columns are finite but for
  /// Stokes and additional ones.
  virtual std::size_t read(RayBlock& block, std::size_t max_rays) = 0;

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

}  // namespace lucerna
