// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lucerna/rayset/ray_set.h"

namespace lucerna {

/// Rays per block that readers and writers of large files use: a few MB, so that it stays in the cache.
inline constexpr std::size_t kStreamBlock = 1 << 16;

/// A ray file being read from front to back, block by block; memory does not grow with the file.
/// Every format's reader implements this. Not thread safe.
class RayReader {
 public:
  virtual ~RayReader() = default;

  const RaySetHeader& header() const { return header_; }
  /// Rays in the file, known before the first is read.
  std::uint64_t ray_count() const { return ray_count_; }
  /// The name that `--to` takes: "tm25", "zemax-binary", ...
  const std::string& format() const { return format_; }
  /// What was odd but could be read; each names its place. Grows while rays are read.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Replaces `block` by the next at most `max_rays` rays; returns how many (0 at the end). Every value is finite, every
  /// direction is unit to 1e-3 (and then normalised), every weight >= 0; else InputError with the ray's number and byte.
  virtual std::size_t read(RayBlock& block, std::size_t max_rays) = 0;

 protected:
  RaySetHeader header_;
  std::uint64_t ray_count_ = 0;
  std::string format_;
  std::vector<std::string> warnings_;
};

/// A ray file being written from front to back. The file appears under its name when `finish` returns. Not thread safe.
class RayWriter {
 public:
  virtual ~RayWriter() = default;
  /// Appends a block whose extra columns are those of the header that the writer was made with.
  virtual void write(const RayBlock& block) = 0;
  /// Completes header and footer and renames the file. Call once, last.
  virtual void finish() = 0;
  /// What of the header or columns this format cannot hold, one sentence each.
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  std::vector<std::string> warnings_;
};

}  // namespace lucerna
