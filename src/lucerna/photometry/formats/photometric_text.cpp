// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/photometric_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lucerna {

int decimals_for(double peak, int digits) {
  if (digits >= 17) return -1;
  if (!(peak > 0.0)) return 0;
  const int before_point = static_cast<int>(std::floor(std::log10(peak))) + 1;
  return std::clamp(digits - before_point, 0, 9);
}

std::string number_text(double value, int decimals) {
  if (decimals < 0) {
    char buffer[400];  // the longest double without an exponent has 309 digits before the point or 325 after
                       // it
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed);
    return {buffer, end.ptr};
  }
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, ' ');
  const std::size_t from = line.find_first_not_of(' ');
  if (from == std::string::npos) return {};
  return line.substr(from, line.find_last_not_of(' ') - from + 1);
}

void check_vertical_angles(const IntensityDistribution& d, std::string_view format) {
  const double first = d.gamma_deg.front(), last = d.gamma_deg.back();
  if ((first == 0.0 || first == 90.0) && (last == 90.0 || last == 180.0)) return;
  throw InputError(
      fmt::format("{}: vertical angles {} to {} found, 0 or 90 to 90 or 180 expected", format, first, last));
}

}  // namespace lucerna
