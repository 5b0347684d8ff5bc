// SPDX-License-Identifier: Apache-2.0
#include "tests/support/code_blocks.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "tests/support/text_scan.h"

namespace lucerna::test {

namespace {

constexpr double kRelative = 0.05, kErrorFactor = 2.0;

std::vector<std::string> lines_in(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    line.erase(line.find_last_not_of(" \t\r") + 1);
    lines.push_back(std::move(line));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// A character, a number or, in what is expected, `...`.
struct Token {
  enum class Kind { character, number, anything } kind = Kind::character;
  std::string text;
  bool is_error = false;  ///< a number after "+- "
};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Length of the number that `text` begins with: digits with a point and an exponent; 0 if none.
std::size_t number_length(std::string_view text) {
  std::size_t n = text.starts_with('-') ? 1 : 0;
  if (n >= text.size() || !is_digit(text[n])) return 0;
  const auto digits = [&] {
    while (n < text.size() && is_digit(text[n])) ++n;
  };
  digits();
  if (n + 1 < text.size() && text[n] == '.' && is_digit(text[n + 1])) {
    ++n;
    digits();
  }
  if (n + 2 < text.size() && text[n] == 'e' && (text[n + 1] == '-' || text[n + 1] == '+') &&
      is_digit(text[n + 2])) {
    n += 2;
    digits();
  }
  return n;
}

/// Is a number at `at` part of a word: after a letter, digit, point or hyphen?
bool within_word(std::string_view line, std::size_t at) {
  if (at == 0) return false;
  const char before = line[at - 1];
  return std::isalnum(static_cast<unsigned char>(before)) != 0 || before == '_' || before == '.' ||
         before == '-';
}

std::vector<Token> tokens_of(std::string_view line, bool dots_stand_for_anything) {
  std::vector<Token> tokens;
  for (std::size_t at = 0; at < line.size();) {
    const std::string_view rest = line.substr(at);
    Token token{Token::Kind::character, std::string(rest.substr(0, 1))};
    if (dots_stand_for_anything && rest.starts_with("...")) {
      token = {Token::Kind::anything, "..."};
    } else if (const std::size_t n = within_word(line, at) ? 0 : number_length(rest); n > 0) {
      token = {Token::Kind::number, std::string(rest.substr(0, n)), line.substr(0, at).ends_with("+- ")};
    }
    at += token.text.size();
    tokens.push_back(std::move(token));
  }
  return tokens;
}

/// One in the last decimal; 0 for whole numbers.
double last_decimal(std::string_view number) {
  const std::size_t point = number.find('.');
  if (point == std::string_view::npos) return 0.0;
  const std::size_t decimals = std::min(number.find('e'), number.size()) - point - 1;
  return std::pow(10.0, -static_cast<double>(decimals));
}

bool same_number(const Token& expected, const Token& printed) {
  const double a = std::stod(expected.text), b = std::stod(printed.text);
  if (expected.is_error) return a == b || (a * b > 0.0 && a <= kErrorFactor * b && b <= kErrorFactor * a);
  const double largest = std::max(std::abs(a), std::abs(b));
  const double unit = std::max(last_decimal(expected.text), last_decimal(printed.text));
  return std::abs(a - b) <= std::max(kRelative * largest, 1.01 * unit);
}

bool same_token(const Token& expected, const Token& printed) {
  if (expected.text == printed.text) return true;
  const bool numbers = expected.kind == Token::Kind::number && printed.kind == Token::Kind::number;
  return numbers && same_number(expected, printed);
}

/// Does `text` follow the pattern, of which some items stand for any number of items?
template <class Item, class IsAnything, class Same>
bool follows(const std::vector<Item>& pattern, const std::vector<Item>& text, IsAnything is_anything,
             Same same) {
  std::size_t i = 0, j = 0, after_anything = 0, resume = 0;
  while (j < text.size()) {
    if (i < pattern.size() && is_anything(pattern[i])) {
      after_anything = ++i;
      resume = j;
    } else if (i < pattern.size() && same(pattern[i], text[j])) {
      ++i;
      ++j;
    } else if (after_anything > 0) {
      i = after_anything;
      j = ++resume;
    } else {
      return false;
    }
  }
  while (i < pattern.size() && is_anything(pattern[i])) ++i;
  return i == pattern.size();
}

bool same_line(const std::string& expected, const std::string& printed) {
  const auto is_anything = [](const Token& t) { return t.kind == Token::Kind::anything; };
  return follows(tokens_of(expected, true), tokens_of(printed, false), is_anything, same_token);
}

}  // namespace

std::vector<CodeBlock> code_blocks(std::string_view page) {
  std::vector<CodeBlock> blocks;
  const std::vector<std::string> lines = lines_in(page);
  std::string file;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].starts_with("```")) {
      for (const std::string& word : between(lines[i] + "\n", "`", "`")) {
        if (word.find('.') != std::string::npos && word.find(' ') == std::string::npos) file = word;
      }
      continue;
    }
    CodeBlock block{lines[i].substr(3), i + 1, {}, file};
    for (++i; i < lines.size() && lines[i] != "```"; ++i) block.text += lines[i] + "\n";
    if (i < lines.size()) blocks.push_back(std::move(block));
  }
  return blocks;
}

bool prints_as(std::string_view expected, std::string_view printed) {
  const auto is_anything = [](const std::string& line) {
    const std::size_t begin = line.find_first_not_of(' ');
    return begin != std::string::npos && line.substr(begin) == "...";
  };
  return follows(lines_in(expected), lines_in(printed), is_anything, same_line);
}

}  // namespace lucerna::test
