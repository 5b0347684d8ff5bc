// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/cli/output/describe.h"
#include "lucerna/rayset/files/ray_file_info.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna::cli {

namespace {

Json point(const std::optional<Vec3>& p) { return p ? Json{p->x, p->y, p->z} : Json(); }

std::string text_of(const std::optional<Vec3>& p) {
  return p ? fmt::format("({:.4f}, {:.4f}, {:.4f})", p->x, p->y, p->z) : "-";
}

/// Étendue of the brightest 50, 90 and 99 % of the flux, by the curve that `compare` shows; 0 without flux.
std::array<double, 3> etendue_of(const RayFileInfo& info) {
  const RayBlock& rays = info.some_rays;
  const bool any = std::any_of(rays.weight.begin(), rays.weight.end(), [](float w) { return w > 0.0f; });
  if (!any) return {};
  const EtendueCurve curve = searched_etendue_curve(rays);
  return {curve.at(0.50), curve.at(0.90), curve.at(0.99)};
}

Json rays_json(const std::string& path, const RayFileInfo& info, const std::array<double, 3>& etendue) {
  const RaySummary& s = info.summary;
  Json out;
  out["path"] = path;
  out["format"] = info.format;
  out["rays"] = s.count;
  out[info.header.flux_unit == FluxUnit::lumen ? "flux_lm" : "flux_w"] = to_json(info.header.flux());
  out["flux_ratio"] = to_json(info.flux_ratio);
  out["units"] = info.length_unit;
  out["extent_mm"] = {{"min", point(s.extent_min_mm)}, {"max", point(s.extent_max_mm)}};
  out["surface"] = describe(info.surface);
  out["virtual_focus_mm"] = s.virtual_focus ? point(s.virtual_focus->point_mm) : Json();
  out["backwards_share"] = to_json(s.backwards_share);
  out["etendue_mm2sr"] = {{"p50", etendue[0]}, {"p90", etendue[1]}, {"p99", etendue[2]}};
  out["equal_weights"] = s.equal_weights;
  out["effective_rays"] = s.effective_rays;
  out["spectrum"] = info.spectrum;
  out["warnings"] = info.warnings;
  return out;
}

std::vector<std::string> rays_lines(const RayFileInfo& info, const std::array<double, 3>& etendue) {
  const RaySummary& s = info.summary;
  const std::string_view unit = symbol(info.header.flux_unit);
  std::vector<std::string> lines;
  const auto line = [&](std::string_view what, const std::string& text) {
    lines.push_back(fmt::format("  {:<20}{}", what, text));
  };
  line("format", fmt::format("{}, lengths in {}", info.format, info.length_unit));
  line("rays", fmt::format("{}, {}", s.count,
                           s.equal_weights
                               ? "all of equal flux"
                               : fmt::format("of unequal flux (worth {:.0f} equal ones)", s.effective_rays)));
  if (const auto flux = info.header.flux()) {
    line("flux", fmt::format("{:.6g} {} stated; the rays' own numbers sum to {:.6g} ({:.6g} times)", *flux,
                             unit, s.weight_sum, info.flux_ratio.value_or(std::nan(""))));
  } else {
    line("flux", fmt::format("not stated; the rays' own numbers sum to {:.6g} {}", s.weight_sum, unit));
  }
  line("spectrum", info.spectrum);
  line("starts (mm)", fmt::format("{} to {}", text_of(s.extent_min_mm), text_of(s.extent_max_mm)));
  line("surface", describe(info.surface));
  if (s.virtual_focus) {
    line("virtual focus (mm)",
         text_of(s.virtual_focus->point_mm) +
             (s.virtual_focus->determined ? "" : " (parallel rays: not determined along the beam)"));
  }
  if (s.backwards_share)
    line("backwards (kz < 0)", fmt::format("{:.4f} % of the flux", 100.0 * *s.backwards_share));
  line("etendue (mm2 sr)",
       fmt::format("{:.4g} / {:.4g} / {:.4g} for the brightest 50 / 90 / 99 % of the flux", etendue[0],
                   etendue[1], etendue[2]));
  return lines;
}

}  // namespace

Json to_json(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json to_json(const std::optional<double>& value) { return value ? to_json(*value) : Json(); }

Description describe_rays(const std::string& path, const std::string& format, Session& session) {
  const RayFileInfo info = describe_ray_file(path, {.format = format}, session.progress());
  const auto etendue = session.timed("etendue", [&] { return etendue_of(info); });
  return {rays_json(path, info, etendue), rays_lines(info, etendue), info.warnings};
}

}  // namespace lucerna::cli
