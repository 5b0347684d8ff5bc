// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace lucerna {

/// Rows of equally many numbers.
struct NumberTable {
  std::size_t columns = 0, rows = 0;
  std::vector<double> numbers;  ///< row after row
};

enum class TableHeader {
  none,     ///< every line is numbers
  optional  ///< the first line may be names
};

/// Reads a text file of numbers parted by commas, semicolons or blanks; # begins a comment, empty lines do
/// not count. A file without numbers is an empty table. Throws InputError naming line and column for anything
/// that is no finite number, and for rows of different lengths, or if the file cannot be read or is larger
/// than 2 GiB.
NumberTable read_number_table(const std::filesystem::path& path, TableHeader header = TableHeader::none);

}  // namespace lucerna
