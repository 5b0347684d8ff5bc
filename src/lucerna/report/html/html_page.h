// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/report/html/html_text.h"

namespace lucerna {

/// One self-contained HTML file: style and scripts inside, a content security policy that forbids every
/// request, light and dark, A4 when printed. Sections come in the order they are added. Not thread safe.
class HtmlPage {
 public:
  /// `kind` stands above the title ("Light tracing"); both plain text.
  HtmlPage(std::string kind, std::string title);

  /// A section with a heading and an entry in the contents. `id` is a word; `body` is HTML.
  void section(const std::string& id, const std::string& heading, const std::string& body);

  /// Data for the scripts (html_text.h: data_element).
  void data(const std::string& id, const nlohmann::ordered_json& data);

  /// Appends to a list that the scripts find under `id`, unless it is there; returns the entry's index.
  std::size_t append(const std::string& id, nlohmann::ordered_json entry);

  /// A further script (html_assets.h), after those that every page has; each once, in the order of the calls.
  void script(std::string_view text);

  std::string str() const;

 private:
  std::string kind_, title_, contents_, body_, data_;
  std::vector<std::pair<std::string, nlohmann::ordered_json>> lists_;
  std::vector<std::string_view> scripts_;
};

/// Buttons that save what the figure `file` shows: "svg", "png", "csv". The scripts listen to them.
std::string save_buttons(const std::string& file, const std::vector<std::string>& kinds);

/// A plot with its caption, a line for the value under the cursor and buttons to save it. `file` names the
/// saved files; `attributes` go to the figure (data-detector="0": what the script needs to know), `controls`
/// below the plot; both HTML.
std::string plot_figure(std::string_view svg, const std::string& file, const std::string& caption,
                        const std::string& attributes, const std::string& controls = "");

}  // namespace lucerna
