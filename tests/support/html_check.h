// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace lucerna::test {

/// The first way in which `html` is not well-formed: every element closed in order, attributes quoted, ids
/// unique; empty if none. Enough of a parser for what we write.
std::string html_fault(const std::string& html);

/// Every figure with a `data-key` is the one of the JSON to the digits shown (times its data-factor); returns
/// the keys.
std::set<std::string> check_keyed_figures(const std::string& html, const nlohmann::ordered_json& json);

/// The JSON that the page embeds for its scripts under `id`.
nlohmann::ordered_json embedded(const std::string& html, const std::string& id);

/// What base64_floats and base64_counts packed.
template <class Word>
std::vector<Word> unpacked(const nlohmann::ordered_json& value) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0;
  int bits = 0;
  for (const char c : value.get<std::string>()) {
    if (c == '=') break;
    word = word << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255u);
  }
  std::vector<Word> out(bytes.size() / sizeof(Word));
  std::memcpy(out.data(), bytes.data(), sizeof(Word) * out.size());
  return out;
}

}  // namespace lucerna::test
