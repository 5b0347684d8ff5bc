// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/rayset/formats/common/record_file.h"

/// What the text formats share: after a header comes one line of numbers per ray.
namespace lucerna {

/// Where the lines are and what they hold; a column's `at` counts the numbers of a line.
struct TextLayout {
  RecordLayout numbers;
  /// Bytes of the file that hold the lines, and the number (from 1) of the first.
  std::uint64_t begin = 0, end = 0, first_line = 1;
};

/// Reads such a file in large pieces, parsed on all threads. Numbers are separated by blanks, tabs, commas or
/// semicolons; empty lines and lines that begin with # or ! do not count. A line with more or fewer numbers
/// is faulty. Memory: some 40 MB.
class TextReader final : public RayReader {
 public:
  /// `facts.ray_count` must be what `count_lines` says, or less.
  TextReader(InputFile file, RayFileFacts facts, TextLayout layout, bool salvage);
  std::size_t read(RayBlock& block, std::size_t max_rays) override;

 private:
  void fill();

  InputFile file_;
  TextLayout layout_;
  bool salvage_;
  std::uint64_t next_byte_, next_line_, delivered_ = 0;
  RayBlock pending_;
  std::size_t used_ = 0;
};

/// Lines in [begin, end) of the file that hold a ray.
std::uint64_t count_lines(const InputFile& file, std::uint64_t begin, std::uint64_t end);

/// The numbers that a line consists of; absent if anything else is in it, or nothing.
std::optional<std::vector<double>> numbers_in(std::string_view line);

/// True if the beginning of the file has no control characters but tabs and line ends.
bool is_text(const InputFile& file);

/// The first at most `bytes` of the file.
std::string head_of(const InputFile& file, std::size_t bytes);

/// A text cut into lines, without their ends ("\n" or "\r\n").
std::vector<std::string_view> lines_in(std::string_view text);

/// Rays as lines of numbers in the order of `numbers` (each column's `at`), the shortest decimals that read
/// back to the same float32. Formats on all threads.
class TextRayWriter {
 public:
  TextRayWriter(const std::filesystem::path& path, RecordLayout numbers);
  void write_text(std::string_view text) { file_.write(text); }
  void write_rays(const RayBlock& block);
  std::uint64_t ray_count() const { return count_; }
  OutputFile& file() { return file_; }

 private:
  OutputFile file_;
  RecordLayout numbers_;
  std::uint64_t count_ = 0;
};

}  // namespace lucerna
