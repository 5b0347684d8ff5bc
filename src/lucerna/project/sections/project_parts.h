// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/project.h"
#include "lucerna/project/schema/toml_reader.h"

/// The tables of a project file, each read by a file of its own; what `read_project` is made of. All throw
/// InputErrors with file, line and key.
namespace lucerna::project_parts {

/// Runs `make`; an InputError from the library's own checks (a radius out of range) gets the key's place in
/// the file.
template <class Make>
auto at_key(const TomlReader& reader, std::string_view key, Make&& make) {
  try {
    return make();
  } catch (const InputError& e) {
    reader.fail(key, e.what(), e.cause());
  } catch (const UsageError& e) {
    reader.fail(key, e.what());
  }
}

/// `position_mm`, `axis`, `turn_deg`.
Frame read_placement(TomlReader& reader);

/// One [[source]]; its file and warnings are added to `project`.
PlacedSource read_source(TomlReader reader, Project& project, Progress& progress);

/// `file` with `scale` (mm per unit of the file): a mesh that belongs to the project.
std::shared_ptr<const Mesh> read_mesh_file(TomlReader& reader, Project& project);

/// At which a refractive index is taken where a table does not say.
inline constexpr double kWavelengthNm = 555.0;

/// What light meets at a mirror.
struct MirrorSurface {
  Reflectance reflectance{1.0};
  double slope_error_mrad = 0.0;
  Scatter scatter;
};

/// The lobes of [[scatter]]; none where it is not there.
Scatter read_scatter(TomlReader& reader);

/// `reflectance` or `metal` with [[scatter]], or [data_sheet]; `slope_error_mrad`. What a data sheet makes
/// assume is one of the project's warnings.
MirrorSurface read_mirror_surface(TomlReader& reader, Project& project);

/// The cause of loss that a body is: `name`, by default its file's name without the ending
/// (-2, -3, ... where that is taken); `otherwise` if it has no file.
std::string read_cause(TomlReader& reader, const Scene& scene, const std::string& otherwise);

/// `aperture`, `diameter_mm` or `size_mm`, `hole_diameter_mm`.
Aperture read_aperture(TomlReader& reader, std::optional<double> default_diameter_mm);

/// `intervals` and `coefficients_mm`: a bicubic B-spline with knots over [-half, half] along x and y, on the
/// paraboloid of `focal_mm`; infinite for none.
std::shared_ptr<const HeightSurface> read_spline(TomlReader& reader, double focal_mm, double half_x_mm,
                                                 double half_y_mm);

/// One [[body]], added to the scene: a mesh, a cover glass, or a solid.
void read_body(TomlReader reader, Project& project);

/// One [[reflector]], added to the scene; a mesh becomes a body.
void read_reflector(TomlReader reader, Project& project);

/// One [[detector]], added to the scene.
std::string read_detector(TomlReader reader, Scene& scene);

}  // namespace lucerna::project_parts
