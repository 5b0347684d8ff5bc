// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/geometry.h"

/// What words on the command line mean. Every function throws UsageError with the word and what was expected.
namespace lucerna::cli {

/// A finite number, whole word.
double parse_number(std::string_view word);

/// A flux above 0 that a ray file can state, in single precision; `option` is whose it is.
double parse_flux(std::string_view word, std::string_view option);

/// A share above 0 and at most 1: "1%", "0.5 %" or "0.01".
double parse_share(std::string_view word);

/// A count: digits, or a number like 1e6 that is whole and below 2^53.
std::uint64_t parse_count(std::string_view word);

/// A size in bytes: 65536, 64k, 1MB (decimal), 64KiB, 1MiB (binary).
std::uint64_t parse_size(std::string_view word);

/// Words separated by commas; none of an empty one.
std::vector<std::string> parse_words(std::string_view word);

/// Numbers separated by commas; with `n`, exactly that many.
std::vector<double> parse_numbers(std::string_view word);
std::vector<double> parse_numbers(std::string_view word, std::size_t n);

/// Ray numbers: "N" is 0 .. N-1, "A:B" is A .. B-1.
struct RayRange {
  std::uint64_t first = 0, last = 0;
};
RayRange parse_range(std::string_view word);

/// "AXIS:DEG", as z:90 or -x:12.5 or 1,1,0:30: a right-hand rotation about that axis through the origin.
Frame parse_rotation(std::string_view word);

}  // namespace lucerna::cli
