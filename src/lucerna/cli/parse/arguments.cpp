// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/arguments.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna::cli {

namespace {

[[noreturn]] void refuse(std::string_view word, std::string_view expected) {
  throw UsageError(fmt::format("'{}' is not {}", word, expected));
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> to_whole(double value) {
  if (value < 0.0 || value > 0x1p53 || value != std::floor(value)) return std::nullopt;
  return static_cast<std::uint64_t>(value);
}

}  // namespace

double parse_number(std::string_view word) {
  const auto value = to_number(word);
  if (!value) refuse(word, "a number");
  return *value;
}

double parse_flux(std::string_view word, std::string_view option) {
  const double flux = parse_number(word);
  const auto stated = static_cast<float>(flux);
  if (!(stated > 0.0f && std::isfinite(stated)))
    throw UsageError(fmt::format("{} {} is not > 0, or not what a ray file can state", option, word));
  return flux;
}

double parse_share(std::string_view word) {
  const bool percent = word.ends_with('%');
  std::string_view number = percent ? word.substr(0, word.size() - 1) : word;
  while (number.ends_with(' ')) number.remove_suffix(1);
  const double share = parse_number(number) * (percent ? 0.01 : 1.0);
  if (!(share > 0.0 && share <= 1.0))
    throw UsageError(fmt::format("'{}': expected a share above 0 and at most 1, like 1% or 0.01", word));
  return share;
}

std::uint64_t parse_count(std::string_view word) {
  const auto value = to_number(word);
  if (value && *value > 0x1p53) throw UsageError(fmt::format("'{}' is more than 2^53, about 9e15", word));
  const auto whole = value ? to_whole(*value) : std::nullopt;
  if (!whole) refuse(word, "a whole number (such as 250000 or 1e6)");
  return *whole;
}

std::uint64_t parse_size(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, double>, 15> kUnits{{{"KiB", 0x1p10},
                                                                               {"MiB", 0x1p20},
                                                                               {"GiB", 0x1p30},
                                                                               {"kB", 1e3},
                                                                               {"KB", 1e3},
                                                                               {"MB", 1e6},
                                                                               {"GB", 1e9},
                                                                               {"k", 1e3},
                                                                               {"K", 1e3},
                                                                               {"m", 1e6},
                                                                               {"M", 1e6},
                                                                               {"g", 1e9},
                                                                               {"G", 1e9},
                                                                               {"B", 1.0},
                                                                               {"", 1.0}}};
  for (const auto& [unit, factor] : kUnits) {
    if (!word.ends_with(unit)) continue;
    const auto value = to_number(word.substr(0, word.size() - unit.size()));
    const auto whole = value ? to_whole(*value * factor) : std::nullopt;
    if (whole) return *whole;
    break;
  }
  refuse(word, "a size (such as 65536, 64k, 1MB, 64KiB)");
}

std::vector<std::string> parse_words(std::string_view word) {
  std::vector<std::string> words;
  for (std::string_view rest = word; !rest.empty();) {
    const std::size_t comma = rest.find(',');
    words.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  return words;
}

std::vector<double> parse_numbers(std::string_view word) {
  std::vector<double> values;
  std::string_view rest = word;
  while (true) {
    const std::size_t comma = rest.find(',');
    const auto value = to_number(rest.substr(0, comma));
    if (!value) refuse(word, "numbers separated by commas");
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<double> parse_numbers(std::string_view word, std::size_t n) {
  std::vector<double> values = parse_numbers(word);
  if (values.size() != n) refuse(word, fmt::format("{} number{} separated by commas", n, n == 1 ? "" : "s"));
  return values;
}

RayRange parse_range(std::string_view word) {
  const std::size_t colon = word.find(':');
  if (colon == std::string_view::npos) {
    const std::uint64_t count = parse_count(word);
    if (count == 0) refuse(word, "a number of rays, at least one");
    return {0, count};
  }
  const RayRange range{parse_count(word.substr(0, colon)), parse_count(word.substr(colon + 1))};
  if (range.first >= range.last) refuse(word, "a range A:B with A < B");
  return range;
}

Frame parse_rotation(std::string_view word) {
  constexpr std::string_view kExpected = "a rotation AXIS:DEG (such as z:90 or 1,1,0:30)";
  const std::size_t colon = word.rfind(':');
  if (colon == std::string_view::npos) refuse(word, kExpected);
  const std::string_view axis = word.substr(0, colon);
  const double angle = radians(parse_number(word.substr(colon + 1)));
  if (axis.find(',') != std::string_view::npos) {
    const auto v = parse_numbers(axis, 3);
    const Vec3 vector{v[0], v[1], v[2]};
    if (length(vector) == 0.0) refuse(word, kExpected);
    return Frame::rotation(Direction::from(vector), angle);
  }
  const double sign = axis.starts_with('-') ? -1.0 : 1.0;
  const std::string_view letter = axis.starts_with('-') || axis.starts_with('+') ? axis.substr(1) : axis;
  const Vec3 vector{letter == "x" ? sign : 0.0, letter == "y" ? sign : 0.0, letter == "z" ? sign : 0.0};
  if (length(vector) == 0.0) refuse(word, kExpected);
  return Frame::rotation(Direction::from_unit(vector), angle);
}

}  // namespace lucerna::cli
