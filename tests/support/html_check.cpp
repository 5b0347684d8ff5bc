// SPDX-License-Identifier: Apache-2.0
#include "tests/support/html_check.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>

#include "tests/support/text_scan.h"

namespace lucerna::test {

namespace {

struct Tag {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  bool closes = false, empty = false;
};

/// A text that is eaten from the front.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}
  bool done() const { return rest_.empty(); }
  bool take(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  /// As long a word as is made of letters, digits and `others`.
  std::string word(std::string_view others) {
    return take_while([&](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || others.find(c) != std::string_view::npos;
    });
  }
  bool spaces() {
    return !take_while([](char c) { return c == ' ' || c == '\n' || c == '\t'; }).empty();
  }
  std::string until(char end) {
    return take_while([end](char c) { return c != end; });
  }

 private:
  template <class Test>
  std::string take_while(Test test) {
    std::size_t n = 0;
    while (n < rest_.size() && test(rest_[n])) ++n;
    std::string out(rest_.substr(0, n));
    rest_.remove_prefix(n);
    return out;
  }
  std::string_view rest_;
};

/// What is between < and >; none if it is no tag.
std::optional<Tag> read_tag(std::string_view inside) {
  Scanner scan(inside);
  Tag tag;
  tag.closes = scan.take("/");
  tag.name = scan.word("!");
  if (tag.name.empty()) return std::nullopt;
  while (!scan.done()) {
    const bool apart = scan.spaces();
    if (scan.done()) break;
    if (scan.take("/")) {
      tag.empty = true;
      if (!scan.done()) return std::nullopt;
      break;
    }
    std::string name = scan.word("-:"), value;
    if (!apart || name.empty()) return std::nullopt;
    if (scan.take("=")) {
      if (!scan.take("\"")) return std::nullopt;
      value = scan.until('"');
      if (!scan.take("\"")) return std::nullopt;
    }
    tag.attributes.emplace_back(std::move(name), std::move(value));
  }
  return tag;
}

void check_keyed_figure(const std::string& key, double factor, const std::string& shown,
                        const nlohmann::ordered_json& json) {
  const auto& value = json.at(nlohmann::ordered_json::json_pointer(key));
  if (shown.empty()) {
    EXPECT_TRUE(value.is_null()) << key;
    return;
  }
  const std::size_t point = shown.find('.');
  double digit =
      point == std::string::npos ? 1.0 : std::pow(10.0, -static_cast<double>(shown.size() - point - 1));
  if (shown.find('e') != std::string::npos) digit = 1e-4 * std::abs(std::stod(shown));
  EXPECT_NEAR(std::stod(shown), factor * value.get<double>(), 0.5001 * digit) << key;
}

}  // namespace

std::string html_fault(const std::string& html) {
  static const std::set<std::string> kVoid{"meta", "input", "br", "!DOCTYPE"};
  std::vector<std::string> open;
  std::set<std::string> ids;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "unclosed tag";
    const auto tag = read_tag(std::string_view(html).substr(at + 1, end - at - 1));
    if (!tag) return "not a tag: " + html.substr(at, std::min<std::size_t>(200, end + 1 - at));
    at = end + 1;
    for (const auto& [name, value] : tag->attributes) {
      if (name == "id" && !ids.insert(value).second) return "second id " + value;
    }
    if (kVoid.contains(tag->name) || tag->empty) continue;
    if (!tag->closes) {
      open.push_back(tag->name);
      if (tag->name == "script" || tag->name == "style") {
        at = html.find("</" + tag->name + ">", at);
        if (at == std::string::npos) return "unclosed " + tag->name;
      }
    } else if (open.empty() || open.back() != tag->name) {
      return "closes " + tag->name + " inside " + (open.empty() ? "nothing" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "unclosed " + open.back();
}

std::set<std::string> check_keyed_figures(const std::string& html, const nlohmann::ordered_json& json) {
  std::set<std::string> seen;
  for (const std::string& part : between(html, "<span data-key=", "</span>")) {
    Scanner scan(part);
    if (!scan.take("\"")) continue;
    const std::string key = scan.until('"');
    scan.take("\"");
    double factor = 1.0;
    if (scan.take(" data-factor=\"")) {
      factor = std::stod(scan.until('"'));
      scan.take("\"");
    }
    if (!scan.take(">")) continue;
    const std::string text = scan.until('<');
    check_keyed_figure(key, factor, text.substr(0, text.find_first_not_of("-0123456789.e+")), json);
    seen.insert(key);
  }
  return seen;
}

nlohmann::ordered_json embedded(const std::string& html, const std::string& id) {
  const std::string start = "<script type=\"application/json\" id=\"" + id + "\">";
  const std::size_t at = html.find(start);
  if (at == std::string::npos) return nullptr;
  const std::size_t begin = at + start.size();
  return nlohmann::ordered_json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

}  // namespace lucerna::test
