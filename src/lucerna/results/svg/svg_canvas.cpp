// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {

namespace {

std::string attributes(const SvgStyle& style) {
  std::string out = fmt::format(R"( fill="{}")", style.fill.empty() ? "none" : style.fill);
  if (!style.stroke.empty()) {
    out +=
        fmt::format(R"( stroke="{}" stroke-width="{:g}" stroke-linejoin="round")", style.stroke, style.width);
  }
  if (!style.dash.empty()) out += fmt::format(R"( stroke-dasharray="{}")", style.dash);
  if (style.opacity < 1.0) out += fmt::format(R"( opacity="{:g}")", style.opacity);
  return out;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height) : width_(width), height_(height) {
  rectangle({0.0, 0.0}, width, height, {.fill = "#fff"});
}

void SvgCanvas::line(SvgPoint a, SvgPoint b, const SvgStyle& style) {
  body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"{}/>\n", a.x, a.y, b.x,
                       b.y, attributes(style));
}

void SvgCanvas::polyline(const std::vector<SvgPoint>& points, const SvgStyle& style, bool closed) {
  body_ += closed ? "<polygon points=\"" : "<polyline points=\"";
  for (const SvgPoint& p : points) body_ += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
  body_ += fmt::format("\"{}/>\n", attributes(style));
}

void SvgCanvas::area(const std::vector<std::vector<SvgPoint>>& rings, const SvgStyle& style) {
  body_ += "<path fill-rule=\"evenodd\" d=\"";
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i)
      body_ += fmt::format("{}{:.2f},{:.2f}", i == 0 ? 'M' : ' ', ring[i].x, ring[i].y);
    body_ += 'Z';
  }
  body_ += fmt::format("\"{}/>\n", attributes(style));
}

void SvgCanvas::circle(SvgPoint centre, double radius, const SvgStyle& style) {
  body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"{}/>\n", centre.x, centre.y, radius,
                       attributes(style));
}

void SvgCanvas::rectangle(SvgPoint corner, double width, double height, const SvgStyle& style) {
  body_ += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"{}/>\n", corner.x,
                       corner.y, width, height, attributes(style));
}

void SvgCanvas::text(SvgPoint at, std::string_view text, const SvgText& style) {
  body_ += fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:g}\" text-anchor=\"{}\" fill=\"{}\"{}{}>{}</text>\n",
      at.x, at.y, style.size, style.anchor, style.fill, style.bold ? R"( font-weight="bold")" : "",
      style.turn_deg == 0.0
          ? std::string()
          : fmt::format(" transform=\"rotate({:g} {:.2f} {:.2f})\"", style.turn_deg, at.x, at.y),
      html_escaped(text));
}

void SvgCanvas::begin_clip(SvgPoint corner, double width, double height) {
  body_ += fmt::format(
      "<clipPath id=\"clip{0}\"><rect x=\"{1:.2f}\" y=\"{2:.2f}\" width=\"{3:.2f}\" "
      "height=\"{4:.2f}\"/></clipPath>\n"
      "<g clip-path=\"url(#clip{0})\">\n",
      clips_++, corner.x, corner.y, width, height);
}

void SvgCanvas::end_clip() { body_ += "</g>\n"; }

void SvgCanvas::data(std::string_view name, std::string_view value) {
  data_ += fmt::format(" data-{}=\"{}\"", name, html_escaped(value));
}

std::string SvgCanvas::str() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} "
      "{1:g}\" "
      "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\"{3}>\n{2}</svg>\n",
      width_, height_, body_, data_);
}

double nice_step(double maximum, int wanted) {
  if (!(maximum > 0.0) || !std::isfinite(maximum)) return 1.0;
  const double rough = maximum / std::max(1, wanted);
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 2.5, 5.0}) {
    if (factor * decade >= rough * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

std::string label_number(double value) {
  const double size = std::abs(value);
  if (size != 0.0 && (size < 1e-3 || size >= 1e7)) return fmt::format("{:.3g}", value);
  const int before = size >= 1.0 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 1;
  std::string text = fmt::format("{:.{}f}", value, std::max(0, size >= 1.0 ? 4 - before : 4));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

}  // namespace lucerna
