// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <vector>

#include "lucerna/project/sections/project_parts.h"

namespace lucerna::project_parts {

namespace {

Reflectance read_metal(TomlReader& reader) {
  if (reader.has("reflectance")) reader.fail("reflectance", "found `metal` too, which says what it is");
  const std::string metal = reader.required_word("metal");
  const double wavelength_nm = reader.number("wavelength_nm", kWavelengthNm);
  return at_key(reader, "wavelength_nm", [&] { return metal_reflectance(metal, wavelength_nm); });
}

/// A number, or [[angle of incidence in degrees, value], ...].
Reflectance read_reflectance(TomlReader& reader) {
  if (reader.has("metal")) return read_metal(reader);
  if (reader.has("wavelength_nm")) reader.fail("wavelength_nm", "belongs to `metal`, which is not there");
  return at_key(reader, "reflectance", [&] {
    if (!reader.has_array("reflectance")) return Reflectance(reader.number("reflectance", 1.0));
    std::vector<Reflectance::Entry> table;
    const auto pairs = reader.pairs("reflectance");
    for (const auto& [angle, value] : *pairs) table.push_back({angle, value});
    return Reflectance(std::move(table));
  });
}

/// A lobe by the numbers that its model needs.
ScatterLobe made_of_numbers(TomlReader& lobe, const std::string& model) {
  if (model == "lambert") return lambert_lobe(lobe.required_number("share"));
  if (model == "gaussian") {
    const double share = lobe.required_number("share");
    return gaussian_lobe(share, lobe.required_number("sigma"));
  }
  const double a = lobe.required_number("a"), b = lobe.required_number("b"), g = lobe.required_number("g");
  return at_key(lobe, "a", [&] { return abg_lobe(a, b, g); });
}

ScatterLobe read_lobe(TomlReader lobe) {
  const std::string model = lobe.required_word("model");
  const ScatterLobe made = made_of_numbers(lobe, model);
  const auto refuse = [&](const char* key, const char* others) {
    if (lobe.has(key)) lobe.fail(key, fmt::format("belongs to {}; this is {}", others, model));
  };
  if (model == "abg") refuse("share", "lambert and gaussian");
  if (model != "gaussian") refuse("sigma", "gaussian");
  for (const char* key : {"a", "b", "g"}) {
    if (model != "abg") refuse(key, "abg");
  }
  lobe.finish();
  return made;
}

/// Says what was assumed, in numbers.
std::string assumption(const TomlReader& sheet, const Scatter& scatter) {
  std::string text = fmt::format("{}: assumed of a data sheet:", sheet.path());
  double mirrored = 1.0;
  for (const ScatterLobe& lobe : scatter.lobes()) {
    mirrored -= lobe.share;
    text +=
        lobe.kind == ScatterKind::lambert
            ? fmt::format(" {:.4g} % of the returned light by Lambert's law,", 100.0 * lobe.share)
            : fmt::format(" {:.4g} % in a Gaussian lobe of sigma = {:.4g},", 100.0 * lobe.share, lobe.sigma);
  }
  return text + (mirrored > 1e-9 ? " the rest mirrored" : " nothing mirrored");
}

MirrorSurface read_data_sheet(TomlReader sheet, Project& project) {
  ReflectorSheet stated{.total = sheet.required_number("total"), .diffuse = sheet.required_number("diffuse")};
  if (const auto gloss = sheet.number("gloss_60")) stated.gloss_60 = *gloss;
  MirrorSurface surface;
  surface.scatter =
      at_key(sheet, stated.gloss_60 < 0.0 ? "diffuse" : "gloss_60", [&] { return scatter_of(stated); });
  surface.reflectance = Reflectance(stated.total);
  project.warnings.push_back(assumption(sheet, surface.scatter));
  sheet.finish();
  return surface;
}

/// What the file says of reflectance, and a note where its values say something else.
MirrorSurface read_measured(TomlReader& reader, Project& project) {
  constexpr double kFar = 0.05;
  const std::filesystem::path file = *reader.file("bsdf");
  project.inputs.push_back(file);
  const BsdfTable table = read_bsdf(file, reader.number("wavelength_nm", kWavelengthNm));
  if (table.wavelength_nm > 0.0)
    project.warnings.push_back(
        fmt::format("{}: has several wavelengths; {:g} nm is taken", file.string(), table.wavelength_nm));
  MirrorSurface surface;
  surface.scatter = at_key(reader, "bsdf", [&] { return Scatter(table); });
  std::vector<Reflectance::Entry> stated;
  const std::vector<double> found = surface.scatter.integrals();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double angle = table.incidence_deg[i], total = table.total[i];
    stated.push_back({angle, total});
    if (std::abs(found[i] - total) <= kFar) continue;
    project.warnings.push_back(fmt::format(
        "{}: states a reflectance of {:.4g} at {} degrees, its values add up to {:.4g}; the former is taken",
        file.string(), total, angle, found[i]));
  }
  surface.reflectance = Reflectance(std::move(stated));
  return surface;
}

/// Refuses what `by` says already.
void refuse_beside(TomlReader& reader, const char* by, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (reader.has(key)) reader.fail(key, fmt::format("found `{}` too, which says what it is", by));
  }
}

}  // namespace

Scatter read_scatter(TomlReader& reader) {
  std::vector<ScatterLobe> lobes;
  for (TomlReader& lobe : reader.tables("scatter")) lobes.push_back(read_lobe(std::move(lobe)));
  return at_key(reader, "scatter", [&] { return Scatter(std::move(lobes)); });
}

MirrorSurface read_mirror_surface(TomlReader& reader, Project& project) {
  MirrorSurface surface;
  if (auto sheet = reader.table("data_sheet")) {
    refuse_beside(reader, "data_sheet", {"reflectance", "metal", "wavelength_nm", "scatter", "bsdf"});
    surface = read_data_sheet(std::move(*sheet), project);
  } else if (reader.has("bsdf")) {
    refuse_beside(reader, "bsdf", {"reflectance", "metal", "scatter"});
    surface = read_measured(reader, project);
  } else {
    surface.reflectance = read_reflectance(reader);
    surface.scatter = read_scatter(reader);
  }
  surface.slope_error_mrad = reader.number("slope_error_mrad", 0.0);
  return surface;
}

}  // namespace lucerna::project_parts
