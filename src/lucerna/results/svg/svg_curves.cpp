// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

namespace {

constexpr double kCurvesLeft = 86.0, kCurvesRight = 616.0, kCurvesTop = 84.0, kCurvesBottom = 404.0;

bool shown(const CurveAxis& axis, double value) { return std::isfinite(value) && (!axis.log || value > 0.0); }

/// Calls `see(x, y)` for every point that can be drawn.
template <class See>
void for_each_point(const CurvePlot& plot, const Curve& curve, const See& see) {
  LUCERNA_CHECK(curve.x.size() == curve.y.size(), "{} x, {} y", curve.x.size(), curve.y.size());
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (shown(plot.x, curve.x[i]) && shown(plot.y, curve.y[i])) see(curve.x[i], curve.y[i]);
  }
}

/// From the least to the maximum value, to round numbers; linear axes from 0 if all is above it.
PlotAxis axis_of(const CurveAxis& axis, double min, double max, double at_first, double at_last) {
  double first = axis.first.value_or(axis.log ? std::pow(10.0, std::floor(std::log10(min))) : min);
  double last = axis.last.value_or(axis.log ? std::pow(10.0, std::ceil(std::log10(max))) : max);
  if (!axis.log) {
    if (!axis.first && first > 0.0) first = 0.0;
    const double step = nice_step(std::max(last - first, 1e-300), 6);
    if (!axis.last) last = step * std::ceil(last / step - 1e-9);
    if (!axis.first) first = step * std::floor(first / step + 1e-9);
  }
  if (!(last > first)) last = axis.log ? 10.0 * first : first + 1.0;
  return {first, last, at_first, at_last, axis.log};
}

void draw_curve(SvgCanvas& canvas, const CurvePlot& plot, const Curve& curve, const PlotAxis& x,
                const PlotAxis& y, const std::string& color) {
  std::vector<SvgPoint> points;
  for_each_point(plot, curve, [&](double a, double b) { points.push_back({x.at(a), y.at(b)}); });
  if (curve.dots) {
    for (const SvgPoint& p : points) canvas.circle(p, 2.6, {.stroke = color, .width = 1.4});
  } else if (points.size() == 1) {
    canvas.circle(points[0], 3.0, {.fill = color});
  } else {
    canvas.polyline(points, {.stroke = color, .width = 2.0, .dash = curve.dashed ? "7 4" : ""});
  }
}

void draw_legend(SvgCanvas& canvas, const std::vector<Curve>& curves) {
  double x = kCurvesLeft;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string color(kCurveColors[i % std::size(kCurveColors)]);
    if (curves[i].dots) {
      canvas.circle({x + 12.0, 66.0}, 2.6, {.stroke = color, .width = 1.4});
    } else {
      canvas.line({x, 66.0}, {x + 24.0, 66.0},
                  {.stroke = color, .width = 2.2, .dash = curves[i].dashed ? "7 4" : ""});
    }
    canvas.text({x + 30.0, 70.0}, curves[i].name, {.size = 12.0});
    x += 52.0 + 6.6 * static_cast<double>(curves[i].name.size());
  }
}

}  // namespace

std::string curves_svg(const CurvePlot& plot) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  double x0 = kInf, x1 = -kInf, y0 = kInf, y1 = -kInf;
  for (const Curve& curve : plot.curves) {
    for_each_point(plot, curve, [&](double x, double y) {
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    });
  }
  if (!(x0 <= x1)) throw InputError(plot.title + ": there is nothing to draw");
  const PlotAxis x = axis_of(plot.x, x0, x1, kCurvesLeft, kCurvesRight),
                 y = axis_of(plot.y, y0, y1, kCurvesBottom, kCurvesTop);
  SvgCanvas canvas(640.0, 458.0);
  canvas.data("plot", "curves");
  canvas.data("x", x.data());
  canvas.data("y", y.data());
  draw_title(canvas, plot.title, plot.below);
  draw_grid(canvas, x, ticks(x, 8), "", y, ticks(y, 6), "");
  canvas.begin_clip({kCurvesLeft, kCurvesTop - 2.0}, kCurvesRight - kCurvesLeft,
                    kCurvesBottom - kCurvesTop + 4.0);
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    draw_curve(canvas, plot, plot.curves[i], x, y, std::string(kCurveColors[i % std::size(kCurveColors)]));
  canvas.end_clip();
  draw_legend(canvas, plot.curves);
  canvas.text({0.5 * (kCurvesLeft + kCurvesRight), kCurvesBottom + 40.0}, plot.x.label,
              {.size = 12.5, .anchor = "middle", .fill = "#444"});
  canvas.text({18.0, 0.5 * (kCurvesTop + kCurvesBottom)}, plot.y.label,
              {.size = 12.5, .anchor = "middle", .fill = "#444", .turn_deg = -90.0});
  return canvas.str();
}

namespace {

/// To seven digits: the page needs no more, and JSON writes shorter numbers.
std::vector<double> rounded(const std::vector<double>& values) {
  std::vector<double> out;
  for (const double v : values) {
    const double unit =
        v != 0.0 && std::isfinite(v) ? std::pow(10.0, 6.0 - std::floor(std::log10(std::abs(v)))) : 0.0;
    out.push_back(unit > 0.0 && std::isfinite(unit) ? std::round(v * unit) / unit : v);
  }
  return out;
}

}  // namespace

nlohmann::ordered_json curves_json(const CurvePlot& plot) {
  nlohmann::ordered_json curves = nlohmann::ordered_json::array();
  for (const Curve& c : plot.curves)
    curves.push_back({{"name", c.name}, {"x", rounded(c.x)}, {"y", rounded(c.y)}});
  return {{"x", plot.x.label}, {"y", plot.y.label}, {"curves", std::move(curves)}};
}

}  // namespace lucerna
