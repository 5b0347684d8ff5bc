// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "lucerna/glass_catalogue.h"
#include "lucerna/material.h"
#include "lucerna/optics/shapes/outline.h"
#include "lucerna/project/sections/project_parts.h"

namespace lucerna::project_parts {

std::shared_ptr<const Mesh> read_mesh_file(TomlReader& reader, Project& project) {
  const auto file = reader.file("file");
  if (!file) reader.missing("file", "an .stl or .obj file");
  const double scale = reader.number("scale", 1.0);
  project.inputs.push_back(*file);
  auto mesh = std::make_shared<Mesh>(read_mesh(*file));
  for (Vec3& p : mesh->vertices_mm) p = scale * p;
  return mesh;
}

std::string read_cause(TomlReader& reader, const Scene& scene, const std::string& otherwise) {
  if (auto name = reader.text("name")) {
    if (name->empty()) reader.fail("name", "found an empty name");
    return *name;
  }
  const auto file = reader.file("file");
  const std::string stem = file ? file->stem().string() : otherwise;
  const auto taken = [&](const std::string& name) {
    return name == "mirror" || name == "mirror_back" ||
           std::any_of(scene.glasses.begin(), scene.glasses.end(),
                       [&](const CoverGlass& g) { return g.name == name; }) ||
           std::any_of(scene.solids.begin(), scene.solids.end(),
                       [&](const Solid& s) { return s.name == name; }) ||
           std::any_of(scene.bodies.begin(), scene.bodies.end(),
                       [&](const Body& b) { return b.name == name; });
  };
  std::string name = stem;
  for (int n = 2; taken(name); ++n) name = fmt::format("{}-{}", stem, n);
  return name;
}

namespace {

/// What light meets in a glass or a solid.
struct ClearMedium {
  double refractive_index, absorption_per_mm = 0.0;
  /// Null unless `dispersion` asks for it.
  std::shared_ptr<const Dispersion> dispersion = nullptr;
};

ClearMedium read_catalogue(TomlReader& reader, const std::filesystem::path& file, Project& project) {
  const auto name = reader.text("glass");
  if (!name) reader.missing("glass", "a name of the catalogue");
  const double wavelength_nm = reader.number("wavelength_nm", kWavelengthNm);
  project.inputs.push_back(file);
  CatalogueGlass glass = at_key(reader, "glass", [&] { return read_glass(file, *name); });
  // What the project says of the absorption holds for all wavelengths.
  if (reader.has("absorption_per_mm")) glass.transmittance.clear();
  ClearMedium medium = at_key(reader, "wavelength_nm", [&] {
    return ClearMedium{glass_index(glass, wavelength_nm), glass_absorption_per_mm(glass, wavelength_nm)};
  });
  if (reader.flag("dispersion").value_or(false))
    at_key(reader, "glass",
           [&] { medium.dispersion = std::make_shared<const Dispersion>(dispersion(glass)); });
  return medium;
}

/// The index is a number, or follows from one of `material` and `catalogue`.
ClearMedium read_medium(TomlReader& reader, double index_otherwise, Project& project) {
  const auto material = reader.word("material");
  const auto catalogue = reader.file("catalogue");
  if (!catalogue && reader.has("glass")) reader.fail("glass", "belongs to `catalogue`, which is not there");
  if (!material && !catalogue) {
    for (const char* key : {"wavelength_nm", "dispersion"}) {
      if (reader.has(key)) reader.fail(key, "belongs to `material` or `catalogue`, and neither is there");
    }
    return {reader.number("refractive_index", index_otherwise)};
  }
  if (reader.has("refractive_index")) {
    reader.fail("refractive_index",
                fmt::format("found `{}` too, which says what it is", material ? "material" : "catalogue"));
  }
  if (material && catalogue) reader.fail("catalogue", "found `material` too; expected one of both");
  if (catalogue) return read_catalogue(reader, *catalogue, project);
  const double wavelength_nm = reader.number("wavelength_nm", kWavelengthNm);
  ClearMedium medium{
      at_key(reader, "wavelength_nm", [&] { return refractive_index(*material, wavelength_nm).n; })};
  if (reader.flag("dispersion").value_or(false))
    medium.dispersion = std::make_shared<const Dispersion>(dispersion(*material));
  return medium;
}

/// The medium's own absorption unless the project has another.
double read_absorption_per_mm(TomlReader& reader, const ClearMedium& medium) {
  return reader.number("absorption_per_mm", medium.absorption_per_mm);
}

CoverGlass read_cover_glass(TomlReader& reader, Project& project) {
  if (reader.has("file")) reader.fail("file", "belongs to bodies of triangles; a glass is flat");
  if (reader.has("dispersion")) reader.fail("dispersion", "belongs to role = \"solid\"; this is glass");
  CoverGlass glass;
  glass.name = read_cause(reader, project.scene, glass.name);
  glass.world_from_glass = read_placement(reader);
  glass.aperture = read_aperture(reader, std::nullopt);
  glass.thickness_mm = reader.number("thickness_mm", glass.thickness_mm);
  const ClearMedium medium = read_medium(reader, glass.refractive_index, project);
  glass.refractive_index = medium.refractive_index;
  glass.absorption_per_mm = read_absorption_per_mm(reader, medium);
  at_key(reader, "role", [&] { check(glass); });
  return glass;
}

/// [body.face] or [body.bottom_face]: a face within a wall of this radius.
std::shared_ptr<const HeightSurface> read_face(TomlReader face, double radius_mm) {
  const double half_mm = face.required_number("half_mm", "half the width of the knots' square");
  if (half_mm < radius_mm)
    face.fail("half_mm",
              fmt::format("found {}, expected at least the wall's radius, {}", half_mm, radius_mm));
  if (!face.has("intervals")) face.missing("intervals", "the intervals along x and y");
  if (!face.has("coefficients_mm")) face.missing("coefficients_mm", "the spline's heights");
  auto surface = read_spline(face, std::numeric_limits<double>::infinity(), half_mm, half_mm);
  face.finish();
  return surface;
}

/// [body.array]: lenslets as its top.
std::shared_ptr<const HeightSurface> read_array(TomlReader array) {
  LensArray out;
  out.pitch_mm = array.required_number("pitch_mm", "the distance of neighbouring lenslets");
  out.radius_mm = array.required_number("radius_mm", "the lenslets' radius of curvature");
  out.apex_mm = array.required_number("apex_mm", "the height of their apexes");
  out.conic = array.number("conic", 0.0);
  out.is_hexagonal = array.word("layout").value_or("square") == "hexagonal";
  auto surface = at_key(array, "radius_mm", [&] { return lens_array(out); });
  array.finish();
  return surface;
}

Solid read_solid(TomlReader& reader, Project& project) {
  Solid solid;
  solid.name = read_cause(reader, project.scene, solid.name);
  solid.world_from_solid = read_placement(reader);
  if (const auto outline = reader.pairs("outline_mm")) {
    if (reader.has("file")) reader.fail("file", "found `outline_mm` too, which says what it is");
    solid.outline_mm = *outline;
    if (auto face = reader.table("face")) {
      if (reader.has("array")) reader.fail("array", "found `face` too, which says what the top is");
      solid.face = read_face(std::move(*face), outline->empty() ? 0.0 : outline->back()[0]);
    } else if (auto array = reader.table("array")) {
      solid.face = read_array(std::move(*array));
    } else {
      at_key(reader, "outline_mm", [&] { check_outline(*outline); });
    }
    if (auto bottom = reader.table("bottom_face")) {
      if (!solid.face) reader.fail("bottom_face", "belongs to `face` or `array`, which are not there");
      solid.bottom_face = read_face(std::move(*bottom), outline->empty() ? 0.0 : outline->front()[0]);
    }
  } else {
    for (const char* key : {"face", "array", "bottom_face"}) {
      if (reader.has(key)) reader.fail(key, "belongs to `outline_mm`, which is not there");
    }
    solid.mesh = read_mesh_file(reader, project);
  }
  const ClearMedium medium = read_medium(reader, solid.refractive_index, project);
  solid.refractive_index = medium.refractive_index;
  solid.absorption_per_mm = read_absorption_per_mm(reader, medium);
  solid.dispersion = medium.dispersion;
  solid.smooth_below_deg = reader.number("smooth_below_deg", solid.smooth_below_deg);
  solid.scatter = read_scatter(reader);
  const auto rough = reader.number_or_numbers("scatter_sides");
  if (rough && solid.scatter.empty())
    reader.fail("scatter_sides", "belongs to `scatter`, which is not there");
  if (rough && solid.mesh) reader.fail("scatter_sides", "belongs to `outline_mm`, which is not there");
  if (rough && rough->empty()) reader.fail("scatter_sides", "found an empty list, expected numbers of sides");
  for (const double side : rough.value_or(std::vector<double>()))
    solid.scatter_sides.push_back(static_cast<std::size_t>(side));
  at_key(reader,
         rough        ? "scatter_sides"
         : solid.face ? (reader.has("array") ? "array" : "face")
                      : "role",
         [&] { check(solid); });
  return solid;
}

/// Adds what light passes; false where `role` is nothing of that kind.
bool read_clear(TomlReader& reader, const std::string& role, Project& project) {
  if (role == "glass") {
    project.scene.glasses.push_back(read_cover_glass(reader, project));
  } else if (role == "solid") {
    project.scene.solids.push_back(read_solid(reader, project));
  } else {
    return false;
  }
  reader.finish();
  return true;
}

}  // namespace

void read_body(TomlReader reader, Project& project) {
  const std::string role = reader.word("role").value_or("absorber");
  if (read_clear(reader, role, project)) return;
  Body body;
  body.name = read_cause(reader, project.scene, "body");
  body.world_from_body = read_placement(reader);
  body.only_returning_light = role == "lamp";
  if (role == "mirror") {
    MirrorSurface surface = read_mirror_surface(reader, project);
    body.reflectance = std::move(surface.reflectance);
    body.slope_error_mrad = surface.slope_error_mrad;
    body.scatter = std::move(surface.scatter);
  }
  for (const char* key :
       {"reflectance", "metal", "wavelength_nm", "slope_error_mrad", "scatter", "data_sheet", "bsdf"}) {
    if (role != "mirror" && reader.has(key))
      reader.fail(key, fmt::format("belongs to role = \"mirror\"; this is {}", role));
  }
  const bool may_be_open = reader.flag("open").value_or(false);
  body.mesh = read_mesh_file(reader, project);
  if (const std::size_t open = open_edges(*body.mesh); open > 0 && !may_be_open) {
    reader.fail("file", fmt::format("the mesh is open: {} edges belong to one triangle or to more than two; "
                                    "expected a closed body (open = true takes it as a sheet)",
                                    open));
  }
  reader.finish();
  project.scene.bodies.push_back(std::move(body));
}

}  // namespace lucerna::project_parts
