// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lucerna/core/io/file.h"

namespace lucerna {

/// True if the file begins as gzip does.
bool is_gzip(const InputFile& file);

/// The bytes of a file from front to back; of a gzip file (RFC 1952, any number of members) those that it
/// unpacks to. Memory: 64 KiB. Not thread safe.
class ByteStream {
 public:
  explicit ByteStream(InputFile file);
  ~ByteStream();
  ByteStream(ByteStream&&) noexcept;
  ByteStream& operator=(ByteStream&&) = delete;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  const InputFile& file() const { return file_; }
  const std::string& name() const { return file_.name(); }
  bool is_packed() const { return unpacker_ != nullptr; }
  /// Bytes read so far, which is the place of the next one.
  std::uint64_t position() const { return position_; }
  /// There are no more bytes left than these: exact for a plain file, 1032 times the file for a gzip one
  /// (what deflate can reach).
  std::uint64_t most_left() const;

  /// Reads until `out` is full or the bytes end; returns how many. Fewer than asked for: `fault` may say why.
  std::size_t read(std::span<std::byte> out);
  /// What is wrong with a gzip file that ended early; empty otherwise.
  const std::string& fault() const { return fault_; }

 private:
  struct Unpacker;
  std::size_t unpack(std::span<std::byte> out);
  /// More of the file into the unpacker; false at its end.
  bool feed();

  InputFile file_;
  std::unique_ptr<Unpacker> unpacker_;
  std::uint64_t position_ = 0;
  std::string fault_;
};

}  // namespace lucerna
