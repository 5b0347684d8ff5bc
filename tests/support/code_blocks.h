// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// The code of a Markdown page, and what it prints held against what the page says that it prints.
namespace lucerna::test {

/// What stands between two fences.
struct CodeBlock {
  /// The word after the opening fence: "sh", "text".
  std::string language;
  /// Of the opening fence, from 1.
  std::size_t line = 0;
  /// With the end of its last line; empty for an empty block.
  std::string text;
  /// The last file name in backquotes before the block: `beam.cpp`; empty if there is none.
  std::string file;
};

/// Fences of three backquotes at the left margin; a block that does not end is left out.
std::vector<CodeBlock> code_blocks(std::string_view page);

/// True if `printed` is what `expected` says. `...` represents any text of a line, alone on a line for any
/// number of lines. A number that stands by itself may differ by 5 % or one in its last decimal, one after
/// "+- " by a factor of 2, since other instruction sets and processors end in other digits. Everything
/// else, digits in words among it (C90, LM-63-2002), is exact but for blanks at the ends of lines.
bool prints_as(std::string_view expected, std::string_view printed);

}  // namespace lucerna::test
