// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/cli/output/describe.h"
#include "lucerna/results/json/model_json.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

std::string vector_text(const Json& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

/// Sizes that the kind of support has, in words.
std::string sizes_text(const Json& layer) {
  std::string text;
  const auto add = [&](const char* key, const char* words, const char* unit) {
    if (layer.contains(key)) text += fmt::format(", {} {:.4g} {}", words, layer[key].get<double>(), unit);
  };
  add("radius_mm", "radius", "mm");
  add("length_mm", "length", "mm");
  if (layer.contains("size_mm")) text += fmt::format(", size {} mm", vector_text(layer["size_mm"]));
  add("twist_rad_per_mm", "twist", "rad/mm");
  return text;
}

std::string text_of(const Json& value) { return value.get<std::string>(); }

void describe_layers(Description& d) {
  std::size_t number = 0;
  for (const Json& layer : d.json["chosen"]) {
    d.lines.push_back(fmt::format("  layer {:<14}{} at {} mm, axis {}{}; directions {}", ++number,
                                  text_of(layer["support"]), vector_text(layer["position_mm"]),
                                  vector_text(layer["axis"]), sizes_text(layer),
                                  text_of(layer["directions"])));
    d.lines.push_back(fmt::format("{:22}{:.3f} % of the flux, {} leaves in {} trees of {} chart(s)", "",
                                  100.0 * layer["share"].get<double>(), layer["leaves"].get<std::size_t>(),
                                  layer["trees"].get<std::size_t>(), layer["charts"].get<std::size_t>()));
    if (const std::string why = text_of(layer["why"]); !why.empty()) {
      d.lines.push_back(fmt::format("{:22}why: {}", "", why));
    }
  }
}

void describe_start(Description& d) {
  const std::string surface = text_of(d.json["starting_surface"]);
  const bool on_supports = d.json.contains("chosen") && surface == "none";
  d.lines.push_back(on_supports ? std::string("  rays start          on the supports")
                                : fmt::format("  rays start          on a {}", surface));
}

std::string wavelengths_text(const Json& json) {
  if (json.contains("wavelengths_nm")) {
    const Json& w = json["wavelengths_nm"];
    const auto min = w["min"].get<double>(), max = w["max"].get<double>();
    if (min == max) return fmt::format("{:g} nm", min);
    const auto bands = w["bands"].get<std::size_t>();
    return fmt::format("{:.4g} to {:.4g} nm, {}", min, max,
                       bands > 1 ? fmt::format("in {} bands with layers of their own", bands)
                                 : std::string("the same of all light"));
  }
  if (json.contains("spectra"))
    return json["spectra"].get<std::size_t>() == 1 ? "a spectrum, the same of all light" : "spectra, by ray";
  return "not known";
}

}  // namespace

Description describe_model(const std::string& path) {
  const auto model = load_source_model(path);
  Description d;
  d.json = model_json(*model, path);
  const Json& etendue = d.json["etendue_mm2sr"];
  d.lines = {
      fmt::format("  format              source model (.nfl), method {}, {} bytes", model->method(),
                  d.json["bytes"].get<std::uint64_t>()),
      fmt::format("  made from           {} rays", model->training_rays()),
      fmt::format("  flux                {:.6g} {}", model->flux(), symbol(model->flux_unit())),
      fmt::format("  size                {} layer(s), {} leaves", model->layers(), model->leaves()),
      fmt::format(
          "  etendue (mm2 sr)    {:.4g} / {:.4g} / {:.4g} for the brightest 50 / 90 / 99 % of the flux",
          etendue["p50"].get<double>(), etendue["p90"].get<double>(), etendue["p99"].get<double>()),
      fmt::format("  wavelengths         {}", wavelengths_text(d.json))};
  if (d.json.contains("starting_surface")) describe_start(d);
  if (d.json.contains("chosen")) describe_layers(d);
  if (d.json.contains("clusters")) {
    d.lines.push_back(fmt::format("  clusters            {}, in a mesh of {} triangles",
                                  d.json["clusters"].get<std::size_t>(),
                                  d.json["triangles"].get<std::size_t>()));
  }
  return d;
}

}  // namespace lucerna::cli
