// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/html_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/results/metrics/figure_text.h"
#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {

namespace {

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

/// Replaces every `from` by `to`.
void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

bool is_figure(std::string_view cell) {
  if (cell.starts_with("<span data-key")) return true;
  return !cell.empty() &&
         (cell[0] == '-' || (cell[0] >= '0' && cell[0] <= '9') || cell.starts_with(kNoFigure));
}

}  // namespace

std::string base64_floats(std::span<const double> values) {
  std::vector<std::uint32_t> words;
  words.reserve(values.size());
  for (const double value : values) words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  return base64_counts(words);
}

std::string base64_counts(std::span<const std::uint32_t> values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const std::uint32_t bits : values) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 255u);
  }
  return base64(bytes);
}

std::string inline_svg(std::string_view svg, const std::string& prefix, std::string_view label) {
  if (!svg.starts_with("<svg ")) throw InputError("report: a plot is not an SVG document");
  std::string out(svg);
  replace_all(out, " id=\"", " id=\"" + prefix);
  replace_all(out, "url(#", "url(#" + prefix);
  replace_all(out, "href=\"#", "href=\"#" + prefix);
  return fmt::format("<svg role=\"img\" aria-label=\"{}\" {}", html_escaped(label), out.substr(5));
}

std::string data_element(const std::string& id, const nlohmann::ordered_json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, text);
}

std::string html_table(const HtmlTable& table) {
  const std::string label = html_escaped(table.label);
  std::string out = fmt::format(
      "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\">\n<table>"
      "<caption class=\"quiet\">{0}</caption>\n<thead><tr>",
      label);
  const auto side = [&](std::size_t column) {
    const auto figure = [&](const auto& row) { return column < row.size() && is_figure(row[column]); };
    return column > 0 && std::ranges::all_of(table.rows, figure) ? " class=\"n\"" : "";
  };
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    LUCERNA_CHECK(!table.head[i].empty(), "column {} of table '{}' has no name to read out", i, label);
    out += fmt::format("<th scope=\"col\"{}>{}</th>", side(i), table.head[i]);
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      out += i == 0 ? fmt::format("<th scope=\"row\">{}</th>", row[i])
                    : fmt::format("<td{}>{}</td>", side(i), row[i]);
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

}  // namespace lucerna
