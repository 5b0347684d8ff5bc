// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/view_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/report/html/grid_map.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

struct ViewText {
  const char *name, *x, *y;
};

ViewText text_of(ViewKind kind) {
  switch (kind) {
    case ViewKind::far:
      return {"Far field", "azimuth about the mean direction, deg", "cosine to the mean direction"};
    case ViewKind::near:
      return {"Near plane", "x, mm", "y, mm"};
    case ViewKind::focus:
      return {"Focus plane", "x, mm", "y, mm"};
    case ViewKind::beam:
      return {"Beam of a collimator", "direction cosine u", "direction cosine v"};
    case ViewKind::four_d:
      return {"Four-dimensional", "x, mm; in each tile direction cosine u",
              "y, mm; in each tile direction cosine v"};
  }
  return {"", "", ""};
}

/// The map without its values: axes, and which cell of the view goes where.
GridMap axes_of(ViewKind kind, const ViewWindow& w) {
  const ViewText text = text_of(kind);
  GridMap map;
  map.x_label = text.x;
  map.y_label = text.y;
  map.unit = "% a cell";
  map.size = 250.0;
  map.x_first = w.low[0], map.x_last = w.high[0], map.y_first = w.low[1], map.y_last = w.high[1];
  map.nx = w.cells[0], map.ny = w.cells[1];
  if (kind == ViewKind::far) {
    map.x_first = 360.0 * w.low[1], map.x_last = 360.0 * w.high[1], map.y_first = w.low[0],
    map.y_last = w.high[0];
    map.nx = w.cells[1], map.ny = w.cells[0], map.true_shape = false;
  }
  if (kind == ViewKind::four_d) map.nx = w.cells[0] * w.cells[2], map.ny = w.cells[1] * w.cells[3];
  return map;
}

std::size_t cell_of(ViewKind kind, const ViewWindow& w, std::size_t ix, std::size_t iy) {
  if (kind == ViewKind::far) return iy * w.cells[1] + ix;
  if (kind != ViewKind::four_d) return ix * w.cells[1] + iy;
  return ((ix / w.cells[2] * w.cells[1] + iy / w.cells[3]) * w.cells[2] + ix % w.cells[2]) * w.cells[3] +
         iy % w.cells[3];
}

std::vector<double> shares(ViewKind kind, const ViewCounts& counts, const GridMap& map) {
  const ViewWindow& w = counts.views().window(kind);
  const std::vector<double>& weights = counts.weights(kind);
  std::vector<double> out;
  for (std::size_t iy = 0; iy < map.ny; ++iy) {
    for (std::size_t ix = 0; ix < map.nx; ++ix)
      out.push_back(100.0 * weights[cell_of(kind, w, ix, iy)] / counts.total_weight());
  }
  return out;
}

}  // namespace

std::string view_metrics(HtmlPage& page, ViewKind kind, const ViewCounts& reference, const ViewCounts& test) {
  const std::string word(to_string(kind)), name = text_of(kind).name;
  GridMap map = axes_of(kind, reference.views().window(kind));
  const std::vector<double> p = shares(kind, reference, map), q = shares(kind, test, map);
  const double max = std::max(*std::ranges::max_element(p), *std::ranges::max_element(q));
  std::string out = fmt::format("<h3>{}</h3>\n<div class=\"trio\">\n", name);
  const auto add = [&](const std::string& what) {
    map.title = what;
    out += grid_figure(page, map, word + "-" + what, fmt::format("{}: {}", name, what));
  };
  map.range = {0.0, max};
  map.value = p;
  add("rays");
  map.value = q;
  add("model");
  for (std::size_t i = 0; i < q.size(); ++i) map.value[i] = q[i] - p[i];
  map.range.reset();
  map.diverging = true;
  add("difference");
  return out + "</div>\n";
}

}  // namespace lucerna
