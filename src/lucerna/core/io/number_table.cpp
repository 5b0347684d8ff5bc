// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxTableBytes = std::uint64_t{2} << 30;

}  // namespace

NumberTable read_number_table(const std::filesystem::path& path, TableHeader header) {
  const std::string bytes = read_file(path, kMaxTableBytes);
  std::string_view text = bytes;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);  // a byte order mark, as spreadsheets write
  const std::string file = path.string();
  NumberTable table;
  bool may_be_names = header == TableHeader::optional;
  std::size_t number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++number;
    line = line.substr(0, line.find('#'));
    std::size_t found = 0;
    bool names = false;
    while (true) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r,;"), line.size()));
      if (line.empty()) break;
      const std::string_view word = line.substr(0, line.find_first_of(" \t\r,;"));
      line.remove_prefix(word.size());
      double z = 0.0;
      const char* const begin = word.data() + (word.front() == '+' ? 1 : 0);
      const auto [stop, error] = std::from_chars(begin, word.data() + word.size(), z);
      ++found;
      if (may_be_names && found == 1 && stop == begin) {
        names = true;
        may_be_names = false;
        break;
      }
      if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(z)) {
        throw_input_error(file, fmt::format("line {}, column {}", number, found),
                          "found '{}', expected a finite number", word.substr(0, 40));
      }
      table.numbers.push_back(z);
    }
    if (names || found == 0) continue;
    may_be_names = false;
    if (table.rows == 0) table.columns = found;
    if (found != table.columns) {
      throw_input_error(file, fmt::format("line {}", number),
                        "found {} numbers, expected {} as in the first row", found, table.columns);
    }
    ++table.rows;
  }
  return table;
}

}  // namespace lucerna
