// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/bsdf_words.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/text.h"

namespace lucerna {

namespace {

constexpr double kMaxAngles = 10'000.0, kMaxBrdf = 1e12;
/// Files round what they state.
constexpr double kAboveOne = 1.01;

}  // namespace

BsdfWords::BsdfWords(std::string_view text, std::string file) : file_(std::move(file)) {
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (trimmed(line).starts_with('#')) continue;
    for (const std::string_view word : blank_separated(line)) words_.push_back({word, number});
  }
}

bool BsdfWords::have(std::string_view word) const {
  return std::ranges::find(words_, word, &Word::text) != words_.end();
}

std::string_view BsdfWords::next(const char* expected) {
  if (at_end()) fail("the file ends, expected {}", expected);
  line_ = words_[at_].line;
  return words_[at_++].text;
}

void BsdfWords::skip_line() {
  while (!at_end() && words_[at_].line == line_) ++at_;
}

double BsdfWords::number(const char* expected) {
  const std::string_view word = next(expected);
  const auto value = number_from(word);
  if (!value) fail("found '{}', expected {}", shown(word), expected);
  return *value;
}

void BsdfWords::require(std::string_view word) {
  const std::string expected(word);
  if (const std::string_view found = next(expected.c_str()); found != word)
    fail("found '{}', expected {}", shown(found), word);
}

std::vector<double> BsdfWords::angles(const char* what, double min, double max) {
  const double count = number("the number of angles");
  if (!(count >= 1.0 && count <= kMaxAngles && count == std::floor(count)))
    fail("found {} angles of {}, expected 1 to {}", count, what, kMaxAngles);
  std::vector<double> out;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    out.push_back(number("an angle in degrees"));
    if (!(out.back() >= min && out.back() <= max))
      fail("found an angle of {} degrees for {}, expected {} to {}", out.back(), what, min, max);
    if (i > 0 && !(out.back() > out[out.size() - 2]))
      fail("found an angle of {} degrees after {} for {}, expected them to ascend", out.back(),
           out[out.size() - 2], what);
  }
  return out;
}

void BsdfWords::values(std::size_t n, std::vector<double>& out) {
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    out.push_back(number("a value of the BRDF"));
    if (!(out.back() >= 0.0 && out.back() <= kMaxBrdf))
      fail("found a BRDF of {}, expected 0 to {}", out.back(), kMaxBrdf);
    sum += out.back();
  }
  if (!(sum > 0.0)) fail("found no value above 0 for an incidence");
}

double BsdfWords::total() {
  const double total = number("the total of an incidence (TIS)");
  if (!(total > 0.0 && total <= kAboveOne))
    fail("found a total (TIS) of {}, expected more than 0 to 1", total);
  return std::min(total, 1.0);
}

}  // namespace lucerna
