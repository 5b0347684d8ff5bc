// SPDX-License-Identifier: Apache-2.0
#include "tests/support/text_scan.h"

#include <cctype>
#include <charconv>

namespace lucerna::test {

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    double value = 0.0;
    if (text.front() == '+') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // from_chars knows words such as inf, which are none here.
    const bool number = error == std::errc() && std::isalpha(static_cast<unsigned char>(end[-1])) == 0;
    if (number) numbers.push_back(value);
    text.remove_prefix(number ? static_cast<std::size_t>(end - text.data())
                              : std::min<std::size_t>(1, text.size()));
  }
  return numbers;
}

std::vector<std::string> between(std::string_view text, std::string_view before, std::string_view after) {
  std::vector<std::string> parts;
  for (std::size_t at = text.find(before); at != std::string_view::npos; at = text.find(before, at)) {
    at += before.size();
    const std::size_t end = text.find(after, at);
    if (end == std::string_view::npos) break;
    parts.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return parts;
}

std::optional<std::string> attribute_of(std::string_view text, std::string_view name) {
  const auto values = between(text, std::string(" ") + std::string(name) + "=\"", "\"");
  if (values.empty()) return std::nullopt;
  return values.front();
}

std::vector<TextPoint> points_in(std::string_view text) {
  std::vector<TextPoint> points;
  const std::vector<double> numbers = numbers_in(text);
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
  return points;
}

std::vector<TextPoint> polyline_of(std::string_view svg, std::string_view mark) {
  for (const std::string& tag : between(svg, "<polyline", ">")) {
    if (tag.find(mark) != std::string::npos) return points_in(attribute_of(tag, "points").value_or(""));
  }
  return {};
}

}  // namespace lucerna::test
