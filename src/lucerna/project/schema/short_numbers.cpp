// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/short_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <system_error>

namespace lucerna {

namespace {

/// Of a bare key, a number or a word like true.
bool is_of_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("_+-.").find(c) != std::string_view::npos;
}

/// Where a string that begins at `at` ends: behind its closing quotes.
std::size_t string_end(std::string_view toml, std::size_t at) {
  const char quote = toml[at];
  const std::string three(3, quote);
  const bool is_long = toml.substr(at, 3) == three;
  const std::string_view closing = is_long ? std::string_view(three) : toml.substr(at, 1);
  std::size_t i = at + closing.size();
  while (i < toml.size() && toml.substr(i, closing.size()) != closing) {
    i += quote == '"' && toml[i] == '\\' ? 2 : 1;
  }
  return std::min(i + closing.size(), toml.size());
}

/// A number with a fraction or an exponent in its fewest digits; anything else as it is.
std::string shortened(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = word.find_first_of(".eE") == std::string_view::npos;
  if (whole || error != std::errc() || end != word.data() + word.size()) return std::string(word);
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text.size() < word.size() ? text : std::string(word);
}

}  // namespace

std::string short_numbers(std::string_view toml) {
  std::string out;
  for (std::size_t i = 0; i < toml.size();) {
    std::size_t end = i + 1;
    if (toml[i] == '"' || toml[i] == '\'') {
      end = string_end(toml, i);
      out += toml.substr(i, end - i);
    } else if (is_of_word(toml[i])) {
      while (end < toml.size() && is_of_word(toml[end])) ++end;
      out += shortened(toml.substr(i, end - i));
    } else {
      out += toml[i];
    }
    i = end;
  }
  return out;
}

}  // namespace lucerna
