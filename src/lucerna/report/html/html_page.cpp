// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "lucerna/report/html/html_assets.h"
#include "lucerna/results/svg/html_escaped.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

// Nothing may be fetched from anywhere, whatever a string in the data says.
constexpr const char* kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:";

/// A prefix for ids from any text.
std::string id_prefix(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += plain ? c : '-';
  }
  return "plot-" + out + "-";
}

}  // namespace

HtmlPage::HtmlPage(std::string kind, std::string title) : kind_(std::move(kind)), title_(std::move(title)) {}

void HtmlPage::section(const std::string& id, const std::string& heading, const std::string& body) {
  contents_ += fmt::format("<a href=\"#{}\">{}</a>\n", id, html_escaped(heading));
  body_ += fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-heading\">\n<h2 "
      "id=\"{0}-heading\">{1}</h2>\n{2}</section>\n",
      id, html_escaped(heading), body);
}

void HtmlPage::data(const std::string& id, const nlohmann::ordered_json& data) {
  data_ += data_element(id, data);
}

std::size_t HtmlPage::append(const std::string& id, nlohmann::ordered_json entry) {
  auto found = std::ranges::find(lists_, id, &std::pair<std::string, nlohmann::ordered_json>::first);
  if (found == lists_.end()) found = lists_.insert(found, {id, nlohmann::ordered_json::array()});
  const auto same = std::ranges::find(found->second, entry);
  const auto index = static_cast<std::size_t>(same - found->second.begin());
  if (same == found->second.end()) found->second.push_back(std::move(entry));
  return index;
}

void HtmlPage::script(std::string_view text) {
  const auto same = [&](std::string_view other) { return other.data() == text.data(); };
  if (std::ranges::none_of(scripts_, same)) scripts_.push_back(text);
}

std::string HtmlPage::str() const {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"lucerna {}\">\n<title>{} – "
      "{}</title>\n<style>\n{}</style>\n</head>\n",
      kPolicy, version(), html_escaped(title_), html_escaped(kind_), assets::report_css);
  out += fmt::format(
      "<body>\n<a class=\"skip\" href=\"#main\">Skip to the results</a>\n<header>\n<div><p "
      "class=\"kind\">Lucerna · "
      "{}</p>\n<h1>{}</h1></div>\n<div class=\"tools\"><button type=\"button\" id=\"theme\">Theme: "
      "auto</button>"
      "<button type=\"button\" id=\"print\">Print</button></div>\n</header>\n"
      "<nav aria-label=\"Contents\">\n{}</nav>\n<main id=\"main\">\n{}</main>\n<footer>Made by Lucerna {}. "
      "This file "
      "is complete and works without a network.</footer>\n",
      html_escaped(kind_), html_escaped(title_), contents_, body_, version());
  out += data_;
  for (const auto& [id, list] : lists_) out += data_element(id, list);
  for (const std::string_view text : {assets::report_js, assets::plots_js})
    out += fmt::format("<script>\n{}</script>\n", text);
  for (const std::string_view text : scripts_) out += fmt::format("<script>\n{}</script>\n", text);
  return out + "</body>\n</html>\n";
}

std::string save_buttons(const std::string& file, const std::vector<std::string>& kinds) {
  std::string out = "<span class=\"save\">";
  for (const std::string& kind : kinds) {
    std::string label = kind;
    for (char& c : label) c = static_cast<char>(c - 'a' + 'A');
    out +=
        fmt::format("<button type=\"button\" data-save=\"{0}\" aria-label=\"Save {1} as {2}\">{2}</button>",
                    kind, html_escaped(file), label);
  }
  return out + "</span>";
}

std::string plot_figure(std::string_view svg, const std::string& file, const std::string& caption,
                        const std::string& attributes, const std::string& controls) {
  const std::string name = html_escaped(file), text = html_escaped(caption);
  return fmt::format(
      "<figure class=\"plot\" data-file=\"{0}\" {1}>\n<div class=\"stage\" tabindex=\"0\" role=\"group\" "
      "aria-label=\"{2}: move the cursor with the arrow keys\">{3}</div>\n"
      "<output class=\"cursor\" aria-live=\"polite\">Point at the plot to read values.</output>\n{4}"
      "<figcaption>{2}{5}</figcaption>\n</figure>\n",
      name, attributes, text, inline_svg(svg, id_prefix(file), caption), controls,
      save_buttons(file, {"svg", "csv"}));
}

}  // namespace lucerna
