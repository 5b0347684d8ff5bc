// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_parts.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/report/html/html_text.h"
#include "lucerna/results/metrics/figure_text.h"
#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

bool ResultFigures::has(const std::string& key) const { return json_.contains(Json::json_pointer(key)); }

const Json& ResultFigures::at(const std::string& key) const {
  const Json::json_pointer pointer(key);
  if (!json_.contains(pointer)) throw_input_error(file_, key, "is missing");
  return json_.at(pointer);
}

std::uint64_t ResultFigures::count(const std::string& key) const {
  const Json& value = at(key);
  if (!value.is_number_unsigned()) throw_input_error(file_, key, "found {}, expected a count", value.dump());
  return value.get<std::uint64_t>();
}

double ResultFigures::number(const std::string& key) const {
  const Json& value = at(key);
  if (value.is_null()) return std::nan("");
  if (value.is_object() && value.contains("value")) return number(key + "/value");
  if (!value.is_number()) throw_input_error(file_, key, "found {}, expected a number", value.dump());
  return value.get<double>();
}

std::string ResultFigures::text(const std::string& key) const {
  const Json& value = at(key);
  return html_escaped(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string ResultFigures::figure(const std::string& key, const std::string& error_key) const {
  if (at(key).is_object()) return figure(key + "/value", key + "/standard_error");
  const double value = number(key);
  const std::string shown = error_key.empty() ? figure_text(value) : figure_text(value, number(error_key));
  return fmt::format("<span data-key=\"{}\">{}</span>", html_escaped(key), shown);
}

std::string ResultFigures::fixed(const std::string& key, int decimals) const {
  const double value = number(key);
  return fmt::format("<span data-key=\"{}\">{}</span>", html_escaped(key),
                     std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "–");
}

std::string ResultFigures::percent(const std::string& key, int decimals) const {
  const double value = 100.0 * number(key);
  return fmt::format("<span data-key=\"{}\" data-factor=\"100\">{}</span>", html_escaped(key),
                     std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "–");
}

std::string ResultFigures::percent(const std::string& key, const std::string& error_key) const {
  return fmt::format("<span data-key=\"{}\" data-factor=\"100\">{}</span>", html_escaped(key),
                     figure_text(100.0 * number(key), 100.0 * number(error_key)));
}

std::string pointer_word(const std::string& key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

std::string percent_text(double part, double whole) {
  return whole > 0.0 ? fmt::format("{:.2f} %", 100.0 * part / whole) : "–";
}

std::string card(const std::string& name, const std::string& value, const std::string& unit,
                 const std::string& note) {
  return fmt::format(
      "<div class=\"card\"><dt>{}</dt><dd><b>{} <small>{}</small></b><span>{}</span></dd></div>\n", name,
      value, unit, note);
}

std::string fact(const std::string& name, const std::string& value) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, value);
}

std::string provenance_html(const ResultFigures& result, const std::string& more,
                            const std::string& project) {
  std::string out = "<dl class=\"facts\">\n";
  out += fact("Program", "lucerna " + result.text("/program_version"));
  out += fact("Command", "<code>" + result.text_or_dash("/command") + "</code>");
  out += more;
  out += fact("Threads", result.figure("/threads"));
  std::string times;
  for (const auto& [phase, seconds] : result.at("/wall_s").items()) {
    times += fmt::format("{}{} {} s", times.empty() ? "" : ", ", html_escaped(phase),
                         result.figure("/wall_s/" + pointer_word(phase)));
  }
  out += fact("Wall time", times) + "</dl>\n";
  HtmlTable inputs{"Input files", {"File", "SHA-256"}, {}};
  for (std::size_t i = 0; i < result.at("/inputs").size(); ++i) {
    inputs.rows.push_back({result.text(fmt::format("/inputs/{}/path", i)),
                           fmt::format("<code>{}</code>", result.text(fmt::format("/inputs/{}/sha256", i)))});
  }
  out += html_table(inputs);
  if (project.empty()) return out;
  return out + fmt::format(
                   "<details><summary>Project file</summary>\n<pre tabindex=\"0\" role=\"region\" "
                   "aria-label=\"Project "
                   "file\">{}</pre></details>\n",
                   html_escaped(project));
}

}  // namespace lucerna
