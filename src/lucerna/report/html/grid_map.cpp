// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/grid_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

namespace {

constexpr double kMapLeft = 74.0, kMapTop = 64.0, kMapRight = 112.0;

std::pair<double, double> range_of(const GridMap& map) {
  if (map.range) return *map.range;
  double low = 0.0, high = 0.0;
  for (const double v : map.value) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  if (map.diverging) high = std::max(high, -low), low = -high;
  return {low, high};
}

}  // namespace

std::string grid_svg(const GridMap& map) {
  LUCERNA_CHECK(map.nx > 0 && map.ny > 0 && map.value.size() == map.nx * map.ny, "{} x {} cells, {} values",
                map.nx, map.ny, map.value.size());
  const double across = std::abs(map.x_last - map.x_first), up = std::abs(map.y_last - map.y_first);
  double width = map.size, height = 0.75 * map.size;
  if (map.true_shape && across > 0.0 && up > 0.0) {
    width = std::max(60.0, map.size * std::min(1.0, across / up));
    height = std::max(60.0, map.size * std::min(1.0, up / across));
  }
  const PlotAxis x{map.x_first, map.x_last, kMapLeft, kMapLeft + width};
  const PlotAxis y{map.y_first, map.y_last, kMapTop + height, kMapTop};
  SvgCanvas canvas(kMapLeft + map.size + kMapRight, kMapTop + height + 58.0);
  canvas.data("plot", "grid");
  canvas.data("x", x.data());
  canvas.data("y", y.data());
  draw_title(canvas, map.title, map.below);
  const double cells_x = std::max(2.0, width / 60.0), cells_y = std::max(2.0, height / 50.0);
  draw_grid(canvas, x, ticks(x, static_cast<int>(cells_x)), "", y, ticks(y, static_cast<int>(cells_y)), "");
  canvas.text({kMapLeft + 0.5 * width, kMapTop + height + 38.0}, map.x_label,
              {.size = 12.5, .anchor = "middle", .fill = "#444"});
  canvas.text({16.0, kMapTop + 0.5 * height}, map.y_label,
              {.size = 12.5, .anchor = "middle", .fill = "#444", .turn_deg = -90.0});
  return canvas.str();
}

std::size_t add_grid(HtmlPage& page, const GridMap& map) {
  const auto [low, high] = range_of(map);
  return page.append("grids", {{"nx", map.nx},
                               {"ny", map.ny},
                               {"x", map.x_label},
                               {"y", map.y_label},
                               {"unit", map.unit},
                               {"diverging", map.diverging},
                               {"range", {low, high}},
                               {"value", base64_floats(map.value)},
                               {"standard_error", base64_floats(map.standard_error)}});
}

std::string grid_figure(HtmlPage& page, const GridMap& map, const std::string& file,
                        const std::string& caption) {
  const std::size_t index = add_grid(page, map);
  const std::string controls =
      map.diverging
          ? ""
          : "<div class=\"control\"><label>Colours <select class=\"colours\"><option>viridis</option>"
            "<option>cividis</option></select></label> <label><input type=\"checkbox\" class=\"log\"> "
            "logarithmic</label></div>\n";
  return plot_figure(grid_svg(map), file, caption, fmt::format("data-grid=\"{}\"", index), controls);
}

}  // namespace lucerna
