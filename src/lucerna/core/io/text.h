// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Text files of other programs. All are thread safe; cost: the length of the text.
namespace lucerna {

/// Appends a code point as UTF-8; what is no Unicode scalar value becomes U+FFFD.
void append_utf8(std::string& out, std::uint32_t code_point);

/// A file's text as UTF-8: UTF-16 where it begins with that byte order mark; else a mark of UTF-8 goes, and
/// what is not UTF-8 is read as Windows-1252. A ^Z ends the file.
std::string decoded_text(std::string_view bytes);

/// Lines of `text` at CR LF, LF or CR, without the ends. They point into `text`. A last line end makes no
/// empty line.
std::vector<std::string_view> lines_of(std::string_view text);

/// `text` without blanks, tabs and other control characters at both ends.
std::string_view trimmed(std::string_view text);

/// The words of a line between blanks and tabs. They point into `line`.
std::vector<std::string_view> blank_separated(std::string_view line);

/// The whole of `text` as a finite number: sign, digits, '.', exponent of any length; nothing else ("nan",
/// "inf", "0x").
std::optional<double> number_from(std::string_view text);

}  // namespace lucerna
