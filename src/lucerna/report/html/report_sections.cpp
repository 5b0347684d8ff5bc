// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "lucerna/report/html/html_assets.h"
#include "lucerna/results/metrics/figure_text.h"
#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {

namespace {

/// One entry of the energy balance.
struct Entry {
  std::string name, key;
};

std::vector<Entry> ledger_entries(const ResultFigures& result) {
  std::vector<Entry> entries{{"Out, direct", "/ledger/out_direct"},
                             {"Out, reflected", "/ledger/out_reflected"}};
  for (const auto& [cause, flux] : result.at("/ledger/absorbed").items()) {
    const std::string word = pointer_word(cause);
    std::string name = cause;
    std::replace(name.begin(), name.end(), '_', ' ');
    entries.push_back({"Absorbed: " + html_escaped(name), "/ledger/absorbed/" + word});
  }
  entries.push_back({"Lost", "/ledger/lost"});
  return entries;
}

}  // namespace

std::string energy_balance_html(const ResultFigures& result) {
  const double emitted = result.number("/ledger/emitted");
  const std::string unit = result.text("/ledger/unit");
  HtmlTable table{"Where the light went", {"Part", "Flux, " + unit, "Share"}, {}};
  std::string bar, described;
  double sum = 0.0;
  std::size_t index = 0;
  for (const Entry& e : ledger_entries(result)) {
    const double flux = result.number(e.key), share = emitted > 0.0 ? flux / emitted : 0.0;
    sum += flux;
    const std::size_t tone = index++ % 6;
    if (share > 0.0)
      bar += fmt::format("<span class=\"tone{}\" style=\"flex-grow:{:.6f}\"></span>", tone, share);
    described += fmt::format("{} {}; ", e.name, percent_text(flux, emitted));
    table.rows.push_back({fmt::format("<span class=\"swatch tone{}\"></span>{}", tone, e.name),
                          result.figure(e.key), percent_text(flux, emitted)});
  }
  table.rows.push_back({"Sum", figure_text(sum), percent_text(sum, emitted)});
  return fmt::format("<div class=\"bar\" role=\"img\" aria-label=\"{}\">{}</div>\n", described, bar) +
         html_table(table);
}

void add_view_section(HtmlPage& page, const ViewSource& view) {
  if (view.scene == nullptr) {
    page.section("view", "3D view",
                 fmt::format("<p>There is no 3D view: {}.</p>\n", html_escaped(view.no_scene)));
    return;
  }
  page.section(
      "view", "3D view",
      "<div id=\"scene3d\" class=\"scene3d\"><p class=\"wait\">The 3D view needs scripts.</p></div>\n");
  page.data("scene", scene3d_json(*view.scene, view.options));
  page.script(assets::three_js);
  page.script(assets::scene3d_js);
}

std::string folder_title(const std::filesystem::path& folder) {
  const std::filesystem::path name = folder.lexically_normal();
  return (name.has_filename() ? name : name.parent_path()).filename().string();
}

}  // namespace lucerna
