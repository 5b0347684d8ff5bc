// SPDX-License-Identifier: Apache-2.0
#include "tests/support/prose.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace lucerna::test {

namespace {

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
/// Letters beyond ASCII count as letters.
bool is_letter_or_digit(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
}

std::string trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return std::string(text);
}

/// Characters of UTF-8 text.
std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Is it an item of a list: "- a", "2. a"?
bool begins_item(const std::string& line) {
  std::size_t n = line.find_first_not_of("0123456789");
  if (n == std::string::npos) return false;
  const bool mark = n == 0 ? std::string("-*+").find(line[0]) != std::string::npos : line[n] == '.';
  return mark && n + 1 < line.size() && line[n + 1] == ' ';
}

/// Paragraphs, items, cells and headings, each on one line; what stands in code blocks is left out.
std::vector<std::string> pieces_of(std::string_view page) {
  std::vector<std::string> pieces(1);
  std::istringstream in{std::string(page)};
  bool code = false;
  for (std::string raw; std::getline(in, raw);) {
    const std::string line = trimmed(raw);
    if (line.starts_with("```")) code = !code;
    const bool indented = raw.starts_with("    ") && pieces.back().empty();
    const bool nothing = code || line.empty() || line.starts_with("```") || indented;
    if (nothing || line[0] == '#' || line[0] == '|' || begins_item(line)) pieces.emplace_back();
    if (nothing) continue;
    if (line[0] == '|') {
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, '|');) pieces.push_back(trimmed(cell));
      pieces.emplace_back();
    } else {
      pieces.back() += (pieces.back().empty() ? "" : " ") + line;
      if (line[0] == '#') pieces.emplace_back();
    }
  }
  return pieces;
}

/// Where the sentence that begins at `from` ends.
std::size_t sentence_end(const std::string& piece, std::size_t from) {
  for (std::size_t i = from; i < piece.size(); ++i) {
    if (std::string_view(".?!").find(piece[i]) == std::string_view::npos) continue;
    std::size_t after = i + 1;
    while (after < piece.size() && std::string_view(")*_\"'").find(piece[after]) != std::string_view::npos)
      ++after;
    if (after + 1 >= piece.size()) continue;
    const char next = piece[after + 1];
    if (piece[after] == ' ' && std::islower(static_cast<unsigned char>(next)) == 0) return after;
  }
  return piece.size();
}

std::size_t words_in(const std::string& sentence) {
  std::istringstream in(sentence);
  std::size_t words = 0;
  for (std::string word; in >> word;)
    words += std::any_of(word.begin(), word.end(), is_letter_or_digit) ? 1 : 0;
  return words;
}

}  // namespace

std::vector<std::size_t> long_lines(std::string_view page, std::size_t max_columns) {
  std::vector<std::size_t> numbers;
  std::istringstream in{std::string(page)};
  bool code = false;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with("```")) code = !code;
    const bool one_word = trimmed(line).find(' ') == std::string::npos;
    if (!code && !line.starts_with('|') && !one_word && characters(line) > max_columns)
      numbers.push_back(number);
  }
  return numbers;
}

std::vector<std::string> long_sentences(std::string_view page, std::size_t max_words) {
  std::vector<std::string> found;
  for (const std::string& piece : pieces_of(page)) {
    for (std::size_t from = 0; from < piece.size();) {
      const std::size_t end = sentence_end(piece, from);
      const std::string sentence = trimmed(std::string_view(piece).substr(from, end - from));
      if (words_in(sentence) > max_words) found.push_back(sentence);
      from = end;
    }
  }
  return found;
}

std::vector<std::size_t> lines_taken_for_marks(std::string_view page) {
  std::vector<std::size_t> taken;
  std::istringstream in{std::string(page)};
  bool code = false, in_item = false;
  std::string before;
  std::size_t number = 0;
  for (std::string raw; std::getline(in, raw); ++number) {
    const std::string line = trimmed(raw);
    if (line.starts_with("```")) code = !code;
    const bool item = begins_item(line);
    // What follows an item is the next one, or its own text, which is indented.
    const bool prose = !before.empty() && before[0] != '#' && before[0] != '|' &&
                       !before.starts_with("```") && !before.starts_with("<!--") && !before.ends_with("-->");
    const bool open = prose && std::string_view(".:;!?)").find(before.back()) == std::string_view::npos;
    const bool next_item = in_item && item && !raw.starts_with("  ");
    if (!code && (line.starts_with('%') || (item && open && !next_item))) taken.push_back(number + 1);
    in_item = item || (in_item && !line.empty());
    before = line;
  }
  return taken;
}

}  // namespace lucerna::test
