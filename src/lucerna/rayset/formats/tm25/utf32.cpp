// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/tm25/utf32.h"

#include "lucerna/core/io/text.h"

namespace lucerna {

namespace {

constexpr std::uint32_t kReplacement = 0xFFFD;

bool is_scalar_value(std::uint32_t c) { return c < 0xD800 || (c > 0xDFFF && c <= 0x10FFFF); }

}  // namespace

std::string utf8_from_utf32(std::span<const std::uint32_t> code_points) {
  std::string out;
  for (const std::uint32_t c : code_points) {
    if (c == 0) break;
    append_utf8(out, c);
  }
  return out;
}

std::vector<std::uint32_t> utf32_from_utf8(std::string_view text) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const int more = lead < 0x80                   ? 0
                     : lead >= 0xC2 && lead < 0xE0 ? 1
                     : lead >= 0xE0 && lead < 0xF0 ? 2
                     : lead >= 0xF0 && lead < 0xF5 ? 3
                                                   : -1;
    std::uint32_t c = more <= 0 ? lead : lead & (0x3FU >> more);
    int seen = 0;
    for (; seen < more && i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U;
         ++seen, ++i) {
      c = (c << 6) | (static_cast<unsigned char>(text[i]) & 0x3FU);
    }
    constexpr std::uint32_t kSmallest[] = {0, 0x80, 0x800, 0x10000};
    const bool good = more >= 0 && seen == more && c >= kSmallest[more] && is_scalar_value(c);
    out.push_back(good ? c : kReplacement);
  }
  return out;
}

}  // namespace lucerna
