// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/cli/commands.h"
#include "lucerna/core/error.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/rayset/ray_statistics.h"

namespace lucerna::cli {

namespace {

/// What `info` finds out about one ray file.
struct RayFileInfo {
  std::string path, format, length_unit;
  RaySetHeader header;
  RaySummary summary;
  std::vector<std::string> warnings;
};

RayFileInfo inspect(const std::string& path, Session& session) {
  const auto reader = open_ray_file(path);
  RayStatistics statistics;
  for_each_block(*reader, session.progress(), "read", [&](const RayBlock& block) { statistics.add(block); });
  return {path,
          reader->format(),
          reader->length_unit(),
          reader->header(),
          statistics.result(),
          reader->warnings()};
}

Json point(const std::optional<Vec3>& p) { return p ? Json{p->x, p->y, p->z} : Json(); }

Json to_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json to_json(const RayFileInfo& info) {
  const RaySummary& s = info.summary;
  Json out;
  out["path"] = info.path;
  out["format"] = info.format;
  out["rays"] = s.count;
  out[info.header.flux_unit == FluxUnit::lumen ? "flux_lm" : "flux_w"] = to_json(info.header.flux());
  const auto flux = info.header.flux();
  out["flux_ratio"] = flux && *flux > 0.0 ? Json(s.weight_sum / *flux) : Json();
  out["units"] = info.length_unit;
  out["extent_mm"] = {{"min", point(s.extent_min_mm)}, {"max", point(s.extent_max_mm)}};
  out["virtual_focus_mm"] = s.virtual_focus ? point(s.virtual_focus->point_mm) : Json();
  out["backwards_share"] = to_json(s.backwards_share);
  out["equal_weights"] = s.equal_weights;
  out["effective_rays"] = s.effective_rays;
  out["spectrum"] = {{"tables", info.header.spectra.size()},
                     {"wavelength_nm", info.header.wavelength_nm ? Json(*info.header.wavelength_nm) : Json()},
                     {"per_ray", find_column(info.header.columns, ColumnKind::wavelength_nm).has_value()}};
  out["warnings"] = info.warnings;
  return out;
}

std::string text_of(const std::optional<Vec3>& p) {
  return p ? fmt::format("({:.4f}, {:.4f}, {:.4f})", p->x, p->y, p->z) : "-";
}

void print(const RayFileInfo& info, Session& session) {
  const RaySummary& s = info.summary;
  const std::string_view unit = symbol(info.header.flux_unit);
  session.say(fmt::format("{}", info.path));
  session.say(fmt::format("  format              {}, lengths in {}", info.format, info.length_unit));
  session.say(fmt::format(
      "  rays                {}{}", s.count,
      s.equal_weights ? ", all of equal flux"
                      : fmt::format(", of unequal flux (worth {:.0f} equal ones)", s.effective_rays)));
  if (const auto flux = info.header.flux()) {
    session.say(fmt::format(
        "  flux                {:.6g} {} stated; the rays' own numbers sum to {:.6g} ({:.6g} times)", *flux,
        unit, s.weight_sum, *flux > 0.0 ? s.weight_sum / *flux : 0.0));
  } else {
    session.say(fmt::format("  flux                not stated; the rays' own numbers sum to {:.6g} {}",
                            s.weight_sum, unit));
  }
  session.say(
      fmt::format("  starts (mm)         {} to {}", text_of(s.extent_min_mm), text_of(s.extent_max_mm)));
  if (s.virtual_focus) {
    session.say(fmt::format(
        "  virtual focus (mm)  {}{}", text_of(s.virtual_focus->point_mm),
        s.virtual_focus->determined ? "" : " (rays are parallel: not determined along the beam)"));
  }
  if (s.backwards_share)
    session.say(fmt::format("  backwards (kz < 0)  {:.4f} % of the flux", 100.0 * *s.backwards_share));
  for (const std::string& warning : info.warnings) session.say(fmt::format("  warning: {}", warning));
}

}  // namespace

void add_info(CLI::App& app, Session& session, int&) {
  CLI::App& command = *app.add_subcommand("info", "Say what is in a file");
  auto files = std::make_shared<std::vector<std::string>>();
  command.add_option("FILE", *files, "Ray files")->required();
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.callback([files, &session] {
    session.start();
    Json list = Json::array();
    for (const std::string& path : *files) {
      const RayFileInfo info = session.timed("read", [&] { return inspect(path, session); });
      session.add_input(path);
      if (session.strict && !info.warnings.empty()) throw InputError(info.warnings.front());
      list.push_back(to_json(info));
      print(info, session);
    }
    if (!session.json) return;
    Json result = session.json_head(std::nullopt);
    result["files"] = std::move(list);
    session.print_json(result);
  });
}

}  // namespace lucerna::cli
