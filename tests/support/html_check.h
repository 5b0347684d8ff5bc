// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace lucerna::test {

/// The first way in which `html` is not well-formed: every element closed in order, attributes quoted, ids
/// unique; empty if none. Enough of a parser for what we write.
inline std::string html_fault(const std::string& html) {
  static const std::set<std::string> kVoid{"meta", "input", "br", "!DOCTYPE"};
  static const std::regex kTag(R"re(^<(/?)([!a-zA-Z0-9]+)((?:\s+[-:a-zA-Z0-9]+(?:="[^"<>]*")?)*)\s*(/?)>)re");
  static const std::regex kId(R"re(\sid="([^"]*)")re");
  std::vector<std::string> open;
  std::set<std::string> ids;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "unclosed tag";
    const std::string tag = html.substr(at, end + 1 - at);
    std::smatch m;
    if (!std::regex_search(tag, m, kTag)) return "not a tag: " + tag.substr(0, 200);
    at = end + 1;
    const std::string name = m[2], attributes = m[3];
    std::smatch id;
    if (std::regex_search(attributes, id, kId) && !ids.insert(id[1]).second)
      return "second id " + id[1].str();
    if (kVoid.contains(name) || m[4].length() > 0) continue;
    if (m[1].length() == 0) {
      open.push_back(name);
      if (name == "script" || name == "style") {
        at = html.find("</" + name + ">", at);
        if (at == std::string::npos) return "unclosed " + name;
      }
    } else if (open.empty() || open.back() != name) {
      return "closes " + name + " inside " + (open.empty() ? "nothing" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "unclosed " + open.back();
}

/// Every figure with a `data-key` is the one of the JSON to the digits shown (times its data-factor); returns
/// the keys.
inline std::set<std::string> check_keyed_figures(const std::string& html,
                                                 const nlohmann::ordered_json& json) {
  static const std::regex kKeyed("<span data-key=\"([^\"]*)\"(?: data-factor=\"([0-9]+)\")?>([-0-9.e+]*)");
  std::set<std::string> seen;
  for (std::sregex_iterator it(html.begin(), html.end(), kKeyed), end; it != end; ++it) {
    const std::string key = (*it)[1], shown = (*it)[3];
    const double factor = (*it)[2].length() > 0 ? std::stod((*it)[2]) : 1.0;
    seen.insert(key);
    const auto& value = json.at(nlohmann::ordered_json::json_pointer(key));
    if (shown.empty()) {
      EXPECT_TRUE(value.is_null()) << key;
      continue;
    }
    const std::size_t point = shown.find('.');
    double digit =
        point == std::string::npos ? 1.0 : std::pow(10.0, -static_cast<double>(shown.size() - point - 1));
    if (shown.find('e') != std::string::npos) digit = 1e-4 * std::abs(std::stod(shown));
    EXPECT_NEAR(std::stod(shown), factor * value.get<double>(), 0.5001 * digit) << key;
  }
  return seen;
}

/// The JSON that the page embeds for its scripts under `id`.
inline nlohmann::ordered_json embedded(const std::string& html, const std::string& id) {
  const std::string start = "<script type=\"application/json\" id=\"" + id + "\">";
  const std::size_t at = html.find(start);
  if (at == std::string::npos) return nullptr;
  const std::size_t begin = at + start.size();
  return nlohmann::ordered_json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

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
