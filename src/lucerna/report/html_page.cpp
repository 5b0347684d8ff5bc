// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html_page.h"

#include <fmt/format.h>

#include <utility>

#include "lucerna/core/version.h"
#include "lucerna/report/html_assets.h"

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
      "is complete: it asks nothing of any network.</footer>\n",
      html_escaped(kind_), html_escaped(title_), contents_, body_, version());
  out += data_;
  out += fmt::format("<script>\n{}</script>\n", assets::report_js);
  out += fmt::format("<script>\n{}</script>\n", assets::far_field_map_js);
  if (scene3d_) {
    out +=
        fmt::format("<script>\n{}</script>\n<script>\n{}</script>\n", assets::three_js, assets::scene3d_js);
  }
  return out + "</body>\n</html>\n";
}

std::string plot_figure(std::string_view svg, const std::string& file, const std::string& caption,
                        const std::string& attributes, const std::string& controls) {
  const std::string name = html_escaped(file), text = html_escaped(caption);
  return fmt::format(
      "<figure class=\"plot\" data-file=\"{0}\" {1}>\n<div class=\"stage\" tabindex=\"0\" role=\"group\" "
      "aria-label=\"{2}: move the cursor with the arrow keys\">{3}</div>\n"
      "<output class=\"cursor\" aria-live=\"polite\">Point at the plot to read values.</output>\n{4}"
      "<figcaption>{2}<span class=\"save\"><button type=\"button\" data-save=\"svg\" aria-label=\"Save {0} "
      "as "
      "SVG\">SVG</button><button type=\"button\" data-save=\"csv\" aria-label=\"Save {0} as "
      "CSV\">CSV</button></span>"
      "</figcaption>\n</figure>\n",
      name, attributes, text, inline_svg(svg, id_prefix(file), caption), controls);
}

}  // namespace lucerna
