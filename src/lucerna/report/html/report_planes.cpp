// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lucerna/photometry/metrics/plane_illuminance.h"
#include "lucerna/results/svg/svg_isolux.h"

namespace lucerna {

namespace {

/// From the first to the last side of evenly spaced cells.
std::pair<double, double> sides(const std::vector<double>& middles) {
  const auto n = static_cast<double>(middles.size());
  const double step = middles.size() > 1 ? (middles.back() - middles.front()) / (n - 1.0) : 1.0;
  return {middles.front() - 0.5 * step, middles.back() + 0.5 * step};
}

/// Lines of equal illuminance; nothing where there are too few cells for lines, or no light.
std::string isolux_figure(const PlaneTable& t, std::size_t grid) {
  const auto [x0, x1] = sides(t.x_mm);
  const auto [y0, y1] = sides(t.y_mm);
  PlaneIlluminance e{
      .plane = {.size_x_mm = x1 - x0, .size_y_mm = y1 - y0, .nx = t.x_mm.size(), .ny = t.y_mm.size()},
      .lx = t.value};
  if (e.plane.nx < 2 || e.plane.ny < 2) return "";
  const auto [min, max] = std::ranges::minmax_element(t.value);
  if (!(*max > 0.0)) return "";
  e.min_lx = *min, e.max_lx = *max;
  for (const double lx : e.lx) e.mean_lx += lx / static_cast<double>(e.lx.size());
  const auto best = static_cast<std::size_t>(max - t.value.begin());
  e.max_x_mm = t.x_mm[best % e.plane.nx], e.max_y_mm = t.y_mm[best / e.plane.nx];
  // The mean of the cells about the middle: one, two or four.
  const std::size_t ix = (e.plane.nx - 1) / 2, jx = e.plane.nx / 2, iy = (e.plane.ny - 1) / 2,
                    jy = e.plane.ny / 2;
  for (const std::size_t y : {iy, jy}) {
    for (const std::size_t x : {ix, jx}) e.centre_lx += 0.25 * e.lx[y * e.plane.nx + x];
  }
  e.uniformity = e.mean_lx > 0.0 ? e.min_lx / e.mean_lx : 0.0;
  e.half = lit_area(e, 0.5), e.tenth = lit_area(e, 0.1);
  return plot_figure(isolux_svg(e, t.unit, t.name, "as traced, noise included"), t.name + "-isolux",
                     "Lines of equal illuminance of " + t.name, fmt::format("data-grid=\"{}\"", grid));
}

std::string vector_text(const ResultFigures& result, const std::string& key) {
  std::string out;
  for (std::size_t i = 0; i < result.at(key).size(); ++i)
    out += (i == 0 ? "" : ", ") + result.figure(fmt::format("{}/{}", key, i));
  return "(" + out + ")";
}

std::string plane_facts(const ResultFigures& result, const std::string& key) {
  const std::string unit = result.text(key + "/unit");
  const auto estimate = [&](const std::string& name) {
    return result.figure(key + "/" + name + "/value", key + "/" + name + "/standard_error") + " " + unit;
  };
  std::string out = "<dl class=\"facts\">\n";
  out += fact("Mean", estimate("mean"));
  out += fact("Largest", fmt::format("{} at x {}, y {} mm", estimate("peak"),
                                     result.figure(key + "/peak/x_mm"), result.figure(key + "/peak/y_mm")));
  out += fact("Minimum", estimate("min"));
  if (result.has(key + "/uniformity/value"))
    out += fact("Uniformity", result.figure(key + "/uniformity") + " (minimum over mean)");
  out += fact("Flux", result.figure(key + "/flux") + " " + result.text("/ledger/unit"));
  out += fact("Noise of the image",
              fmt::format("{:.2g} % (relative RMS)", 100.0 * result.number(key + "/noise")));
  out +=
      fact("Place", fmt::format("centre {} mm, normal {}, up {}; {} mm, {} cells",
                                vector_text(result, key + "/position_mm"),
                                vector_text(result, key + "/normal"), vector_text(result, key + "/up"),
                                vector_text(result, key + "/size_mm"), vector_text(result, key + "/cells")));
  if (result.has(key + "/half_angle_deg"))
    out += fact("Seen", "from afar, within " + result.figure(key + "/half_angle_deg") + "° of the normal");
  if (result.has(key + "/from_mm"))
    out += fact("Seen",
                fmt::format("from {} mm through a pupil of {} mm radius",
                            vector_text(result, key + "/from_mm"), result.figure(key + "/pupil_radius_mm")));
  return out + "</dl>\n";
}

}  // namespace

GridMap plane_map(const PlaneTable& t) {
  GridMap map;
  map.title = t.name;
  map.below = t.luminance ? "luminance" : "illuminance";
  map.x_label = "x, mm", map.y_label = "y, mm";
  std::tie(map.x_first, map.x_last) = sides(t.x_mm);
  std::tie(map.y_first, map.y_last) = sides(t.y_mm);
  map.nx = t.x_mm.size(), map.ny = t.y_mm.size();
  map.value = t.value;
  map.standard_error = t.standard_error;
  map.unit = t.value_unit;
  return map;
}

void add_plane_sections(HtmlPage& page, const ResultFigures& result, const std::vector<PlaneTable>& planes) {
  std::size_t number = 0, files = 0;
  HtmlTable rays{"Rays that left, as files", {"File", "Format", "Rays", "Flux"}, {}};
  for (std::size_t i = 0; i < result.at("/detectors").size(); ++i) {
    const std::string key = fmt::format("/detectors/{}", i), kind = result.text(key + "/kind");
    if (kind == "rays") {
      rays.rows.push_back({result.text(key + "/file"), result.text(key + "/format"),
                           result.figure(key + "/rays"),
                           result.figure(key + "/flux") + " " + result.text(key + "/unit")});
      ++files;
    }
    if (kind != "plane" && kind != "luminance") continue;
    const PlaneTable& plane = planes.at(number);
    const GridMap map = plane_map(plane);
    std::string body = plane_facts(result, key) + "<div class=\"plots\">\n" +
                       grid_figure(page, map, plane.name + "-map",
                                   (plane.luminance ? "Luminance of " : "Illuminance of ") + plane.name);
    if (!plane.luminance) body += isolux_figure(plane, add_grid(page, map));
    page.section(fmt::format("plane-{}", number++),
                 (plane.luminance ? "Luminance image: " : "Illuminance: ") + plane.name, body + "</div>\n");
  }
  if (files > 0) page.section("rays", "Ray files", html_table(rays));
}

}  // namespace lucerna
