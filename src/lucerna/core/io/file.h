// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lucerna {

/// A file being written: bytes go to a temporary name beside `path`, `commit` renames it. Without `commit`
/// (an exception, an interrupt) nothing is left behind and an older file of that name is untouched. Not
/// thread safe.
class OutputFile {
 public:
  /// Throws InputError if the place cannot be written.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends; throws InputError when the disk is full.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }

  /// Overwrites bytes already written, from `offset` (a header whose counts are known only at the end).
  void patch(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Flushes, checks and renames. Call once, last.
  void commit();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
};

/// Writes a whole file through OutputFile.
void write_file(const std::filesystem::path& path, std::string_view text);

/// The ending of a name in lower case, ".ies"; empty if it has none.
std::string lower_ending(const std::filesystem::path& path);

/// The whole of a small file. Throws InputError if it cannot be read or is larger than `max_bytes`.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Reads a file from the front, with its size known before: what a streaming reader stands on. Not thread
/// safe.
class InputFile {
 public:
  /// Throws InputError if it does not exist, is a directory or cannot be read.
  explicit InputFile(const std::filesystem::path& path);

  std::uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }

  /// Reads exactly `out.size()` bytes at `offset`; throws InputError with offset, wanted and found if there
  /// are fewer.
  void read_at(std::uint64_t offset, std::span<std::byte> out) const;

 private:
  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string name_;
  std::uint64_t size_ = 0;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// SHA-256 of a file's bytes, 64 hexadecimal digits.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace lucerna
