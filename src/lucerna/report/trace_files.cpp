// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/trace_files.h"

#include <fmt/format.h>

#include <cmath>

#include "lucerna/core/file.h"
#include "lucerna/core/version.h"
#include "lucerna/photometry/photometric_file.h"
#include "lucerna/report/svg_polar.h"

namespace lucerna {

namespace {

/// The light-emitting area that photometric files state: the opening of the first mirror, if it looks up or
/// down.
void set_luminous_size(LuminaireData& luminaire, const Scene& scene) {
  if (scene.reflectors.empty()) return;
  const PlacedReflector& placed = scene.reflectors.front();
  if (std::abs(placed.world_from_reflector.ez().z) < 0.999) return;
  const Aperture& aperture = placed.reflector.aperture;
  luminaire.luminous_length_mm = 2.0 * aperture.half_y_mm();
  luminaire.luminous_width_mm = aperture.shape() == ApertureShape::circle ? 0.0 : 2.0 * aperture.half_x_mm();
  luminaire.length_mm = luminaire.luminous_length_mm;
  luminaire.width_mm = luminaire.luminous_width_mm;
}

PhotometricFile photometric_file(const FarFieldFigures& figures, const Scene& scene) {
  PhotometricFile file{figures.intensity.distribution, {}};
  file.luminaire.name = figures.field.name;
  file.luminaire.manufacturer = "Lucerna simulation";
  file.luminaire.report_number = fmt::format("lucerna-{}", version());
  file.luminaire.test_lab = "none (computer simulation)";
  set_luminous_size(file.luminaire, scene);
  return file;
}

}  // namespace

std::string far_field_csv(const FarFieldFigures& figures) {
  const IntensityDistribution& d = figures.intensity.distribution;
  const bool error_known = !figures.intensity.standard_error_cd.empty();
  const char* unit = d.unit == FluxUnit::lumen ? "cd" : "w_per_sr";
  std::string csv = fmt::format("c_deg,gamma_deg,intensity_{0},standard_error_{0}\n", unit);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      csv += fmt::format("{:g},{:g},{:.9g},", d.c_deg[c], d.gamma_deg[g], d.at(c, g));
      if (error_known)
        csv += fmt::format("{:.4g}", figures.intensity.standard_error_cd[c * d.gamma_deg.size() + g]);
      csv += '\n';
    }
  }
  return csv;
}

std::vector<std::string> write_trace_files(const std::filesystem::path& folder, const Project& project,
                                           const TraceFigures& figures,
                                           const nlohmann::ordered_json& result) {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file(folder / name, text);
    names.push_back(name);
  };
  for (const FarFieldFigures& f : figures.far_fields) {
    const PhotometricFile file = photometric_file(f, project.scene);
    if (f.field.unit == FluxUnit::lumen) write(f.field.name + ".ldt", ldt_text(file));
    write(f.field.name + ".ies", ies_text(file, PhotometricFormat::ies_2019));
    write(f.field.name + ".csv", far_field_csv(f));
    write(f.field.name + ".svg", polar_svg(f.intensity.distribution, {.title = f.field.name}));
  }
  write("project.toml", project_text(project));
  // Last: a folder with a result.json is complete.
  write("result.json", result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  return names;
}

}  // namespace lucerna
