// SPDX-License-Identifier: Apache-2.0
#include "lucerna/error_parts.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace lucerna {

namespace {

constexpr std::size_t kNone = std::string_view::npos;
constexpr std::string_view kColon = ": ";

/// "line 3", "line 3, column 7", "byte 20", "ray 17 (byte 37468)", "unpacked byte 8".
bool is_position(std::string_view text) {
  for (const std::string_view word : {"line ", "byte ", "ray ", "unpacked byte "}) {
    if (text.starts_with(word) && text.size() > word.size() && std::isdigit(text[word.size()]) != 0)
      return true;
  }
  return false;
}

/// "design.limits.max_height_mm", "reflector[0].focal_mm", "source".
bool is_key(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_' || c == '.' || c == '[' || c == ']';
  });
}

/// True where the text begins with a file whatever follows it.
bool is_about_a_file(ErrorCause cause) {
  constexpr std::array kCauses{ErrorCause::not_found, ErrorCause::unreadable, ErrorCause::unwritable,
                               ErrorCause::no_space, ErrorCause::damaged};
  return std::find(kCauses.begin(), kCauses.end(), cause) != kCauses.end();
}

/// Takes file and place off the front of `text`.
void take_place(std::string_view& text, ErrorCause cause, ErrorParts& parts) {
  const std::size_t file = text.find(kColon);
  if (file == kNone) return;
  std::string_view rest = text.substr(file + kColon.size());
  const std::string_view all = rest;
  while (true) {
    const std::size_t end = rest.find(kColon);
    const std::string_view part = rest.substr(0, end);
    // A key comes after a line, or first.
    if (end == kNone || !(is_position(part) || is_key(part))) break;
    rest.remove_prefix(end + kColon.size());
    if (is_key(part)) break;
  }
  const std::size_t place = all.size() - rest.size();
  if (place == 0 && !is_about_a_file(cause)) return;
  parts.path = text.substr(0, file);
  if (place > 0) parts.place = all.substr(0, place - kColon.size());
  text = rest;
}

/// Where the clause that ends at `end` begins: after the last ", ", ": " or "; " before.
std::size_t clause_start(std::string_view text, std::size_t end) {
  std::size_t start = 0;
  const std::string_view before = text.substr(0, end);
  for (const std::string_view mark : {", ", ": ", "; "}) {
    const std::size_t at = before.rfind(mark);
    if (at != kNone) start = std::max(start, at + mark.size());
  }
  return start;
}

/// "..., found X, expected Y", or "X, expected Y".
void take_clauses(std::string_view text, ErrorParts& parts) {
  constexpr std::string_view kFound = "found ", kExpected = "expected ";
  const std::size_t expected = text.rfind(kExpected);
  if (expected != kNone) parts.expected = text.substr(expected + kExpected.size());
  std::string_view before = text.substr(0, expected);
  while (!before.empty() && std::string_view(" ,;").find(before.back()) != kNone) before.remove_suffix(1);
  const std::size_t found = before.rfind(kFound);
  if (found != kNone) {
    parts.found = before.substr(found + kFound.size());
  } else if (expected != kNone) {
    parts.found = before.substr(clause_start(before, before.size()));
  }
}

}  // namespace

ErrorParts error_parts(const Error& error) {
  ErrorParts parts;
  std::string_view text = error.what();
  take_place(text, error.cause(), parts);
  take_clauses(text, parts);
  return parts;
}

}  // namespace lucerna
