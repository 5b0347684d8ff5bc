// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/number_table.h"
#include "lucerna/optics/height_field/height_map.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/optics/shapes/spline_surface.h"
#include "lucerna/project/sections/project_parts.h"

namespace lucerna::project_parts {

Aperture read_aperture(TomlReader& reader, std::optional<double> default_diameter_mm) {
  const std::string shape = reader.word("aperture").value_or("circle");
  const auto diameter = reader.number("diameter_mm");
  const auto size = reader.numbers("size_mm", 2);
  const double hole = reader.number("hole_diameter_mm", 0.0);
  if (shape == "circle") {
    if (size) reader.fail("size_mm", "belongs to a rectangular aperture; a circle has diameter_mm");
    if (!diameter && !default_diameter_mm) reader.missing("diameter_mm");
    return at_key(reader, "aperture",
                  [&] { return Aperture::circle(diameter ? *diameter : *default_diameter_mm, hole); });
  }
  if (diameter) reader.fail("diameter_mm", "belongs to a circular aperture; a rectangle has size_mm");
  if (!size) reader.missing("size_mm");
  return at_key(reader, "aperture", [&] { return Aperture::rectangle((*size)[0], (*size)[1], hole); });
}

namespace {

/// The aperture of a height map: all of it, or a circle within it.
Aperture read_map_aperture(TomlReader& reader, double half_x_mm, double half_y_mm) {
  const std::string shape = reader.word("aperture").value_or("rectangle");
  const auto diameter = reader.number("diameter_mm");
  const double hole = reader.number("hole_diameter_mm", 0.0);
  if (shape == "rectangle") {
    if (diameter) reader.fail("diameter_mm", "belongs to a circular aperture");
    return at_key(reader, "hole_diameter_mm",
                  [&] { return Aperture::rectangle(2.0 * half_x_mm, 2.0 * half_y_mm, hole); });
  }
  const double max = 2.0 * std::min(half_x_mm, half_y_mm);
  if (diameter && *diameter > max) {
    reader.fail("diameter_mm", fmt::format("found {}, the heights reach {} mm", *diameter, max));
  }
  return at_key(reader, "hole_diameter_mm", [&] { return Aperture::circle(diameter.value_or(max), hole); });
}

/// An ellipsoid past its equator, closed in to a mouth.
Reflector read_deep_ellipse(TomlReader& reader, double focal_mm, double focal2_mm, double mouth_mm,
                            bool trough) {
  if (trough) reader.fail("mouth_diameter_mm", "belongs to family = \"revolution\"");
  for (const char* key : {"diameter_mm", "size_mm"}) {
    if (reader.has(key)) reader.fail(key, "the mirror ends at mouth_diameter_mm; expected one of both");
  }
  const std::string shape = reader.word("aperture").value_or("circle");
  if (shape != "circle") reader.fail("aperture", fmt::format("found '{}', a mouth is a circle", shape));
  const double hole = reader.number("hole_diameter_mm", 0.0);
  return at_key(reader, "mouth_diameter_mm",
                [&] { return deep_ellipse_reflector(focal_mm, focal2_mm, mouth_mm, hole); });
}

Reflector read_conic(TomlReader& reader, const std::string& preset, bool trough) {
  static const std::map<std::string, ConicPreset, std::less<>> kPresets{
      {"parabola", ConicPreset::parabola},
      {"ellipse", ConicPreset::ellipse},
      {"hyperbola", ConicPreset::hyperbola}};
  const ConicPreset conic = kPresets.at(preset);
  const auto focal = reader.number("focal_mm"), focal2 = reader.number("focal2_mm");
  if (!focal) reader.missing("focal_mm");
  if (conic == ConicPreset::parabola && focal2) reader.fail("focal2_mm", "a parabola has one focus");
  if (conic != ConicPreset::parabola && !focal2) reader.missing("focal2_mm");
  if (const auto mouth = reader.number("mouth_diameter_mm")) {
    if (conic != ConicPreset::ellipse) {
      reader.fail("mouth_diameter_mm", fmt::format("a {} does not close in again", preset));
    }
    return read_deep_ellipse(reader, *focal, *focal2, *mouth, trough);
  }
  const Aperture aperture = read_aperture(reader, std::nullopt);
  return at_key(reader, "preset", [&] {
    const auto make = trough ? conic_trough : conic_reflector;
    return make(conic, *focal, focal2.value_or(0.0), aperture);
  });
}

/// The profile of `file`: lines of r, z; the first may be names.
std::vector<ProfileKnot> read_profile_file(const std::filesystem::path& path) {
  const NumberTable table = read_number_table(path, TableHeader::optional);
  if (table.columns != 2) {
    throw_input_error(path.string(), "", "has {} columns, expected two: r and z in mm", table.columns);
  }
  std::vector<ProfileKnot> knots;
  for (std::size_t i = 0; i < table.rows; ++i)
    knots.push_back({table.numbers[2 * i], table.numbers[2 * i + 1]});
  return knots;
}

/// The families that a profile makes, turned about z or drawn along y.
Reflector read_profile_family(TomlReader& reader, bool trough, Project& project) {
  const auto preset = reader.word("preset");
  const auto profile = reader.pairs("profile_mm");
  const auto file = reader.file("file");
  if (preset && profile) reader.fail("profile_mm", "a reflector has either a preset or a profile");
  if (file && (preset || profile)) {
    reader.fail("file", fmt::format("the reflector has a {} too; expected one of both",
                                    preset ? "preset" : "profile_mm"));
  }
  if (preset) return read_conic(reader, *preset, trough);
  if (!profile && !file) {
    reader.missing("preset", "the reflector needs a preset or a profile_mm or a file with a profile");
  }
  const char* const key = file ? "file" : "profile_mm";
  std::vector<ProfileKnot> knots;
  if (file) {
    project.inputs.push_back(*file);
    knots = read_profile_file(*file);
  } else {
    for (const auto& [r, z] : *profile) knots.push_back({r, z});
  }
  if (knots.empty()) reader.fail(key, "found no points, expected at least two");
  std::optional<double> mouth = 2.0 * knots.back().r_mm;
  if (!(*mouth > 0.0)) mouth = std::nullopt;
  const Aperture aperture = read_aperture(reader, mouth);
  return at_key(reader, key, [&] { return (trough ? profile_trough : profile_reflector)(knots, aperture); });
}

/// Facets on a base of revolution: flat, or pillows of a radius of curvature.
Reflector read_faceted(TomlReader& reader, Project& project) {
  const double pitch = reader.required_number("pitch_mm", "the side of a facet");
  const double radius = reader.number("pillow_radius_mm", std::numeric_limits<double>::infinity());
  Reflector base = read_profile_family(reader, false, project);
  if (base.curve) {
    reader.fail("family",
                "facets need a base that is a function of the radius; this one is vertical or turns back "
                "towards the axis");
  }
  return at_key(reader, "pillow_radius_mm", [&] {
    return Reflector{std::make_shared<FacetedSurface>(base.surface, pitch, radius), base.aperture};
  });
}

/// The free-form family: a bicubic B-spline of heights over a paraboloid (docs/theory/design.md).
Reflector read_bspline(TomlReader& reader) {
  const double focal = reader.required_number("focal_mm", "the paraboloid that the spline stands on");
  const Aperture aperture = read_aperture(reader, std::nullopt);
  return {read_spline(reader, focal, aperture.half_x_mm(), aperture.half_y_mm()), aperture};
}

/// Heights of a file over `size_mm`: z = z_offset_mm + z_scale_mm * value.
Reflector read_heightmap(TomlReader& reader, Project& project) {
  const auto file = reader.file("file");
  if (!file) reader.missing("file", "the heights, a .csv, .txt, .npy, .pgm or .png file");
  const auto size = reader.numbers("size_mm", 2);
  if (!size) reader.missing("size_mm", "the distances [x, y] from the first to the last sample");
  const bool from_top = reader.word("first_row").value_or("top") == "top";
  project.inputs.push_back(*file);
  HeightMap map = read_height_map(*file, from_top ? FirstRow::top : FirstRow::bottom);
  const auto scale = reader.number("z_scale_mm");
  if (map.white && !scale) reader.missing("z_scale_mm", "the mm that one grey level represents");
  if (map.white && *map.white < 256.0) {
    project.warnings.push_back(
        fmt::format("{}: {} levels of grey make steps of {} mm; a mirror wants 16 bits", file->string(),
                    *map.white + 1.0, std::abs(*scale)));
  }
  const double offset = reader.number("z_offset_mm", 0.0);
  for (double& z : map.z) z = offset + scale.value_or(1.0) * z;
  const double a = 0.5 * (*size)[0], b = 0.5 * (*size)[1];
  const Aperture aperture = read_map_aperture(reader, a, b);
  return {std::make_shared<SplineSurface>(SplineSurface::through({-a, a, -b, b}, map.nx, map.ny, map.z)),
          aperture};
}

/// A mesh as a mirror: no height field, so it reflects on both sides.
void read_mesh_mirror(TomlReader& reader, Project& project) {
  Body body;
  body.name = read_cause(reader, project.scene, "body");
  body.world_from_body = read_placement(reader);
  MirrorSurface surface = read_mirror_surface(reader, project);
  body.reflectance = std::move(surface.reflectance);
  body.slope_error_mrad = surface.slope_error_mrad;
  body.scatter = std::move(surface.scatter);
  const bool smooth = reader.flag("smooth_normals").value_or(false);
  if (!smooth && reader.has("crease_deg")) reader.fail("crease_deg", "needs smooth_normals = true");
  if (smooth) body.smooth_below_deg = reader.number("crease_deg", 30.0);
  body.mesh = read_mesh_file(reader, project);
  at_key(reader, "crease_deg", [&] { return check(body), 0; });
  project.scene.bodies.push_back(std::move(body));
}

Reflector read_family(TomlReader& reader, const std::string& family, Project& project) {
  if (family == "revolution") return read_profile_family(reader, false, project);
  if (family == "trough") return read_profile_family(reader, true, project);
  if (family == "faceted") return read_faceted(reader, project);
  if (family == "bspline") return read_bspline(reader);
  return read_heightmap(reader, project);
}

}  // namespace

std::shared_ptr<const HeightSurface> read_spline(TomlReader& reader, double focal_mm, double half_x_mm,
                                                 double half_y_mm) {
  const auto intervals = reader.numbers("intervals", 2).value_or(std::vector<double>{4.0, 4.0});
  const KnotRow x{-half_x_mm, 2.0 * half_x_mm / intervals[0], static_cast<int>(intervals[0])};
  const KnotRow y{-half_y_mm, 2.0 * half_y_mm / intervals[1], static_cast<int>(intervals[1])};
  const auto n = static_cast<std::size_t>(x.coefficients()) * static_cast<std::size_t>(y.coefficients());
  std::vector<double> c(n, 0.0);
  if (reader.has("coefficients_mm")) c = *reader.numbers("coefficients_mm", n);
  // What is steeper is no optic, and would be searched for hits without end.
  const double most = 1e3 * std::max(half_x_mm, half_y_mm);
  const auto steep = std::find_if(c.begin(), c.end(), [&](double z) { return std::abs(z) > most; });
  if (steep != c.end()) {
    reader.fail("coefficients_mm", fmt::format("found {}, expected at most {} mm, a thousand times half the "
                                               "aperture",
                                               *steep, most));
  }
  return std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(focal_mm, x, y, std::move(c)));
}

void read_reflector(TomlReader reader, Project& project) {
  const std::string family = reader.required_word("family");
  if (family == "mesh") {
    read_mesh_mirror(reader, project);
    return reader.finish();
  }
  PlacedReflector placed;
  placed.world_from_reflector = read_placement(reader);
  placed.reflector = read_family(reader, family, project);
  MirrorSurface surface = read_mirror_surface(reader, project);
  placed.reflectance = std::move(surface.reflectance);
  placed.slope_error_mrad = surface.slope_error_mrad;
  placed.scatter = std::move(surface.scatter);
  reader.finish();
  project.scene.reflectors.push_back(std::move(placed));
}

}  // namespace lucerna::project_parts
