// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reading of what we write (SVG, HTML, STEP), for tests. Not std::regex: that recurs once a character, which
/// overflows the stack under the address sanitizer, and costs seconds in every file that includes it.
namespace lucerna::test {

inline bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// The decimal numbers in a text, whatever else is between them.
std::vector<double> numbers_in(std::string_view text);

/// What stands between each `before` and the next `after`, in order.
std::vector<std::string> between(std::string_view text, std::string_view before, std::string_view after);

/// The value of the first attribute `name="value"` in a text; none if there is none.
std::optional<std::string> attribute_of(std::string_view text, std::string_view name);

struct TextPoint {
  double x, y;
};
/// The numbers in a text, two by two.
std::vector<TextPoint> points_in(std::string_view text);

/// The points of the first `<polyline` whose tag holds the text `mark`; empty if there is none.
std::vector<TextPoint> polyline_of(std::string_view svg, std::string_view mark);

}  // namespace lucerna::test
