// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/ray_file.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/results/svg/svg_axes.h"
#include "lucerna/results/svg/svg_polar.h"
#include "lucerna/version.h"

namespace lucerna {

namespace {

PhotometricFile photometric_file(const FarFieldResult& figures, const TraceOrigin& origin) {
  PhotometricFile file{figures.intensity.distribution, {}};
  file.luminaire.name = figures.field.name;
  file.luminaire.manufacturer = "Lucerna simulation";
  file.luminaire.report_number = fmt::format("lucerna-{}", version());
  file.luminaire.test_lab = "none (computer simulation)";
  file.luminaire.generation_type = kGenerationSimulated;
  file.luminaire.generation_info = "Computer simulation by Lucerna (light tracing)";
  file.luminaire.luminous_length_mm = file.luminaire.length_mm = origin.luminous_length_mm;
  file.luminaire.luminous_width_mm = file.luminaire.width_mm = origin.luminous_width_mm;
  return file;
}

}  // namespace

std::string far_field_csv(const FarFieldResult& figures) {
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

std::string plane_csv(const PlaneMetrics& figures) {
  const PlaneImage& image = figures.image;
  const bool lumen = image.unit == FluxUnit::lumen;
  const std::string figure = figures.view ? (lumen ? "luminance_cd_per_m2" : "radiance_w_per_m2_sr")
                                          : (lumen ? "illuminance_lx" : "irradiance_w_per_m2");
  std::string csv =
      fmt::format("x_mm,y_mm,{0},standard_error_{1}\n", figure, figure.substr(figure.find('_') + 1));
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    csv += fmt::format("{:.9g},{:.9g},{:.9g},", image.grid.cell_x_mm(i), image.grid.cell_y_mm(i),
                       image.value[i]);
    if (std::isfinite(image.standard_error[i])) csv += fmt::format("{:.4g}", image.standard_error[i]);
    csv += '\n';
  }
  return csv;
}

PlanePicture plane_picture(const PlaneImage& image) {
  const std::size_t nx = image.grid.nx, ny = image.grid.ny;
  const std::size_t side = std::clamp<std::size_t>((511 + std::max(nx, ny)) / std::max(nx, ny), 1, 64);
  const double max = *std::max_element(image.value.begin(), image.value.end());
  PlanePicture p{nx * side, ny * side, {}};
  p.rgb.reserve(3 * p.width * p.height);
  for (std::size_t row = 0; row < p.height; ++row) {
    for (std::size_t column = 0; column < p.width; ++column) {
      const double value = image.value[(ny - 1 - row / side) * nx + column / side];
      for (const int c : viridis_rgb(max > 0.0 ? value / max : 0.0))
        p.rgb.push_back(static_cast<std::uint8_t>(c));
    }
  }
  return p;
}

namespace {

/// Writes the rays that left in the format of every ray detector. Weights become fluxes, as TM-25 has them.
std::vector<std::string> write_rays(const std::filesystem::path& folder, const TraceMetrics& figures,
                                    const RayBlock& rays, std::vector<std::string>* warnings) {
  std::vector<std::string> names;
  if (figures.rays.empty()) return names;
  RaySet set;
  set.header.flux_unit = figures.ledger.unit;
  set.header.set_flux(figures.rays.front().flux.mean);
  set.header.creation_method = 0;
  set.rays = rays;
  double sum = 0.0;
  for (const float w : rays.weight) sum += static_cast<double>(w);
  for (float& w : set.rays.weight)
    w = static_cast<float>(static_cast<double>(w) / sum * figures.rays.front().flux.mean);
  for (const RayOutputMetrics& f : figures.rays) {
    // Other formats have no place for it, and would warn of it.
    set.header.texts.file_creator = f.detector.format == "tm25" ? fmt::format("lucerna {}", version()) : "";
    names.push_back(ray_file_name(f.detector));
    for (std::string& w : write_ray_set(folder / names.back(), set, f.detector.format)) {
      if (warnings != nullptr) warnings->push_back(names.back() + ": " + std::move(w));
    }
  }
  return names;
}

}  // namespace

std::vector<std::string> write_trace_files(const std::filesystem::path& folder, const TraceOrigin& origin,
                                           const TraceMetrics& figures, const RayBlock& rays,
                                           const nlohmann::ordered_json& result,
                                           std::vector<std::string>* warnings) {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file(folder / name, text);
    names.push_back(name);
  };
  for (const FarFieldResult& f : figures.far_fields) {
    const PhotometricFile file = photometric_file(f, origin);
    if (f.field.unit == FluxUnit::lumen) write(f.field.name + ".ldt", ldt_text(file));
    write(f.field.name + ".ies", ies_text(file, PhotometricFormat::ies_2019));
    write(f.field.name + ".csv", far_field_csv(f));
    write(f.field.name + ".svg",
          polar_svg(f.intensity.distribution, {.title = f.field.name,
                                               .standard_error = f.intensity.standard_error_cd,
                                               .figures = drawn_figures(f)}));
  }
  for (const auto* images : {&figures.planes, &figures.luminances}) {
    for (const PlaneMetrics& f : *images) {
      write(f.image.name + ".csv", plane_csv(f));
      const PlanePicture picture = plane_picture(f.image);
      write_png(folder / (f.image.name + ".png"), picture.width, picture.height, picture.rgb);
      names.push_back(f.image.name + ".png");
    }
  }
  for (std::string& name : write_rays(folder, figures, rays, warnings)) names.push_back(std::move(name));
  write("project.toml", origin.project);
  // Last: a folder with a result.json is complete.
  write("result.json", result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  return names;
}

}  // namespace lucerna
