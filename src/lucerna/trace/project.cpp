// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/project.h"

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "lucerna/core/error.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/reflector/faceted_surface.h"
#include "lucerna/reflector/smooth_shape.h"
#include "lucerna/source/emitter.h"
#include "lucerna/source/ray_set_source.h"
#include "lucerna/source/source_model.h"
#include "lucerna/trace/toml_reader.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// Runs `make`; an InputError from the library's own checks (a radius out of range) gets the key's place in
/// the file.
template <class Make>
auto at_key(const TomlReader& reader, std::string_view key, Make&& make) {
  try {
    return make();
  } catch (const InputError& e) {
    reader.fail(key, e.what());
  } catch (const UsageError& e) {
    reader.fail(key, e.what());
  }
}

Frame read_placement(TomlReader& reader) {
  const Vec3 position = reader.vector("position_mm").value_or(Vec3{});
  const Direction axis = reader.axis("axis").value_or(Direction());
  return Frame::from_axis(axis, radians(reader.number("turn_deg", 0.0)), position);
}

struct GivenFlux {
  double flux = 0.0;
  FluxUnit unit = FluxUnit::lumen;
};

std::optional<GivenFlux> read_flux(TomlReader& reader) {
  const auto lm = reader.positive("flux_lm"), w = reader.positive("flux_w");
  if (lm && w) reader.fail("flux_w", "flux_lm and flux_w exclude each other");
  if (lm) return GivenFlux{*lm, FluxUnit::lumen};
  if (w) return GivenFlux{*w, FluxUnit::watt};
  return std::nullopt;
}

/// `surface` with `surface_mm`: one number or an array of them.
std::optional<BoundingSurface> read_surface(TomlReader& reader) {
  const auto name = reader.text("surface");
  const auto mm = reader.number_or_numbers("surface_mm");
  if (!name && mm) reader.fail("surface_mm", "needs surface");
  if (!name) return std::nullopt;
  const SurfaceKind kind = at_key(reader, "surface", [&] { return surface_kind(*name); });
  return at_key(reader, mm ? "surface_mm" : "surface",
                [&] { return BoundingSurface::from_sizes(kind, mm.value_or(std::vector<double>())); });
}

std::shared_ptr<const RaySource> read_emitter(TomlReader& reader, const std::optional<GivenFlux>& flux) {
  EmitterOptions options;
  options.kind = at_key(reader, "kind", [&] { return emitter_kind(reader.required_text("kind")); });
  options.radius_mm = reader.positive("radius_mm");
  options.length_mm = reader.positive("length_mm");
  if (const auto size = reader.numbers("size_mm", 2)) options.size_mm = {(*size)[0], (*size)[1]};
  options.ghost_share = reader.number("ghost_share", options.ghost_share);
  options.surface = read_surface(reader);
  if (flux) {
    options.flux = flux->flux;
    options.flux_unit = flux->unit;
  }
  return at_key(reader, "kind", [&] { return make_emitter(options); });
}

std::shared_ptr<const RaySource> read_ray_file_source(TomlReader& reader, const fs::path& file,
                                                      const std::optional<GivenFlux>& flux, Project& project,
                                                      Progress& progress) {
  auto rays = std::make_shared<RaySet>(read_ray_set(file, {}, progress, &project.warnings));
  if (flux) {
    if (flux->unit != rays->header.flux_unit) {
      reader.fail(flux->unit == FluxUnit::lumen ? "flux_lm" : "flux_w",
                  fmt::format("the rays of {} carry {}; lumen and watt are never mixed", file.string(),
                              symbol(rays->header.flux_unit)));
    }
    rays->header.set_flux(flux->flux);
  }
  return std::make_shared<RaySetSource>(std::move(rays), file.string());
}

/// A model; PlacedSource::flux overrides what it holds.
std::shared_ptr<const RaySource> read_model_source(TomlReader& reader, const fs::path& file,
                                                   const std::optional<GivenFlux>& flux) {
  std::shared_ptr<const RaySource> model = load_source_model(file);
  if (flux && flux->unit != model->flux_unit()) {
    reader.fail(flux->unit == FluxUnit::lumen ? "flux_lm" : "flux_w",
                fmt::format("the model {} carries {}; lumen and watt are never mixed", file.string(),
                            symbol(model->flux_unit())));
  }
  return model;
}

PlacedSource read_source(TomlReader reader, Project& project, Progress& progress) {
  PlacedSource source;
  source.world_from_source = read_placement(reader);
  const auto flux = read_flux(reader);
  const auto file = reader.file("file");
  if (file) {
    if (reader.has("kind")) reader.fail("kind", "a source has either a file or a kind");
    project.inputs.push_back(*file);
    if (is_source_model(*file)) {
      source.rays = read_model_source(reader, *file, flux);
      if (flux) source.flux = flux->flux;
    } else {
      source.rays = read_ray_file_source(reader, *file, flux, project, progress);
    }
  } else {
    if (!reader.has("kind")) reader.fail("kind", "is missing: a source needs a file or a kind");
    source.rays = read_emitter(reader, flux);
  }
  reader.finish();
  return source;
}

Aperture read_aperture(TomlReader& reader, std::optional<double> default_diameter_mm) {
  const std::string shape = reader.text("aperture").value_or("circle");
  const auto diameter = reader.positive("diameter_mm");
  const auto size = reader.numbers("size_mm", 2);
  const double hole = reader.number("hole_diameter_mm", 0.0);
  if (shape == "circle") {
    if (size) reader.fail("size_mm", "belongs to a rectangular aperture; a circle has diameter_mm");
    if (!diameter && !default_diameter_mm) reader.fail("diameter_mm", "is missing");
    return at_key(reader, "aperture",
                  [&] { return Aperture::circle(diameter ? *diameter : *default_diameter_mm, hole); });
  }
  if (shape == "rectangle") {
    if (diameter) reader.fail("diameter_mm", "belongs to a circular aperture; a rectangle has size_mm");
    if (!size) reader.fail("size_mm", "is missing");
    return at_key(reader, "aperture", [&] { return Aperture::rectangle((*size)[0], (*size)[1], hole); });
  }
  reader.fail("aperture", fmt::format("found '{}', expected circle or rectangle", shape));
}

Reflector read_conic(TomlReader& reader, const std::string& preset, bool trough) {
  static const std::map<std::string, ConicPreset, std::less<>> kPresets{
      {"parabola", ConicPreset::parabola},
      {"ellipse", ConicPreset::ellipse},
      {"hyperbola", ConicPreset::hyperbola}};
  const auto found = kPresets.find(preset);
  if (found == kPresets.end()) {
    reader.fail("preset", fmt::format("found '{}', expected parabola, ellipse or hyperbola", preset));
  }
  const auto focal = reader.positive("focal_mm"), focal2 = reader.positive("focal2_mm");
  if (!focal) reader.fail("focal_mm", "is missing");
  if (found->second == ConicPreset::parabola && focal2) reader.fail("focal2_mm", "a parabola has one focus");
  if (found->second != ConicPreset::parabola && !focal2) reader.fail("focal2_mm", "is missing");
  const Aperture aperture = read_aperture(reader, std::nullopt);
  return at_key(reader, "preset", [&] {
    const auto make = trough ? conic_trough : conic_reflector;
    return make(found->second, *focal, focal2.value_or(0.0), aperture);
  });
}

/// The families that a profile makes, turned about z or drawn along y.
Reflector read_profile_family(TomlReader& reader, bool trough) {
  const auto preset = reader.text("preset");
  const auto profile = reader.pairs("profile_mm");
  if (preset && profile) reader.fail("profile_mm", "a reflector has either a preset or a profile");
  if (preset) return read_conic(reader, *preset, trough);
  if (!profile) reader.fail("preset", "is missing: the reflector needs a preset or a profile_mm");
  if (profile->empty()) reader.fail("profile_mm", "found no points, expected at least two");
  std::vector<ProfileKnot> knots;
  for (const auto& [r, z] : *profile) knots.push_back({r, z});
  const Aperture aperture = read_aperture(reader, 2.0 * knots.back().r_mm);
  return at_key(reader, "profile_mm",
                [&] { return (trough ? profile_trough : profile_reflector)(knots, aperture); });
}

/// Facets on a base of revolution: flat, or pillows of a radius of curvature.
Reflector read_faceted(TomlReader& reader) {
  const auto pitch = reader.positive("pitch_mm");
  if (!pitch) reader.fail("pitch_mm", "is missing: the side of a facet");
  const double radius = reader.number("pillow_radius_mm", std::numeric_limits<double>::infinity());
  Reflector base = read_profile_family(reader, false);
  return at_key(reader, "pillow_radius_mm", [&] {
    return Reflector{std::make_shared<FacetedSurface>(base.surface, *pitch, radius), base.aperture};
  });
}

/// The free-form family: a bicubic B-spline of heights over a paraboloid (docs/algorithms/design.md).
Reflector read_bspline(TomlReader& reader) {
  const auto focal = reader.positive("focal_mm");
  if (!focal) reader.fail("focal_mm", "is missing: the paraboloid that the spline stands on");
  const auto intervals = reader.numbers("intervals", 2).value_or(std::vector<double>{4.0, 4.0});
  for (const double n : intervals) {
    if (!(n >= 1.0 && n <= 1000.0 && n == std::floor(n))) {
      reader.fail("intervals", fmt::format("found {}, expected whole numbers from 1 to 1000", n));
    }
  }
  const Aperture aperture = read_aperture(reader, std::nullopt);
  const double a = aperture.half_x_mm(), b = aperture.half_y_mm();
  const KnotRow x{-a, 2.0 * a / intervals[0], static_cast<int>(intervals[0])};
  const KnotRow y{-b, 2.0 * b / intervals[1], static_cast<int>(intervals[1])};
  const auto n = static_cast<std::size_t>(x.coefficients()) * static_cast<std::size_t>(y.coefficients());
  std::vector<double> c(n, 0.0);
  if (reader.has("coefficients_mm")) c = *reader.numbers("coefficients_mm", n);
  return {std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(*focal, x, y, std::move(c))), aperture};
}

/// A number, or [[angle of incidence in degrees, value], ...].
Reflectance read_reflectance(TomlReader& reader) {
  return at_key(reader, "reflectance", [&] {
    if (!reader.has_array("reflectance")) return Reflectance(reader.number("reflectance", 1.0));
    std::vector<Reflectance::Entry> table;
    const auto pairs = reader.pairs("reflectance");
    for (const auto& [angle, value] : *pairs) table.push_back({angle, value});
    return Reflectance(std::move(table));
  });
}

Reflector read_family(TomlReader& reader) {
  const std::string family = reader.required_text("family");
  if (family == "revolution") return read_profile_family(reader, false);
  if (family == "trough") return read_profile_family(reader, true);
  if (family == "faceted") return read_faceted(reader);
  if (family == "bspline") return read_bspline(reader);
  reader.fail("family", fmt::format("found '{}', expected revolution, trough, bspline or faceted", family));
}

PlacedReflector read_reflector(TomlReader reader) {
  PlacedReflector placed;
  placed.world_from_reflector = read_placement(reader);
  placed.reflector = read_family(reader);
  placed.reflectance = read_reflectance(reader);
  placed.slope_error_mrad = reader.number("slope_error_mrad", 0.0);
  if (!(placed.slope_error_mrad >= 0.0)) reader.fail("slope_error_mrad", "expected >= 0");
  reader.finish();
  return placed;
}

FarFieldDetector read_detector(TomlReader reader) {
  const std::string kind = reader.required_text("kind");
  if (kind != "far-field") reader.fail("kind", fmt::format("found '{}', expected far-field", kind));
  FarFieldDetector detector;
  detector.name = reader.text("name").value_or(kind);
  detector.c_step_deg = reader.positive("c_step_deg").value_or(detector.c_step_deg);
  detector.gamma_step_deg = reader.positive("gamma_step_deg").value_or(detector.gamma_step_deg);
  if (detector.name.empty() || detector.name.find_first_of("/\\") != std::string::npos ||
      detector.name[0] == '.') {
    reader.fail("name", "names files: not empty, no slash, no leading dot");
  }
  at_key(reader, "kind", [&] {
    FarFieldGrid grid(detector);
    return grid.size();
  });
  reader.finish();
  return detector;
}

/// Makes every `file` of the tables absolute, so that the project can be written to another folder.
void make_files_absolute(toml::table& table, const fs::path& folder) {
  for (auto&& [key, node] : table) {
    if (auto* inner = node.as_table()) make_files_absolute(*inner, folder);
    if (auto* array = node.as_array()) {
      for (auto&& item : *array) {
        if (auto* inner = item.as_table()) make_files_absolute(*inner, folder);
      }
    }
    if (key.str() == "file" && node.is_string()) {
      auto& value = node.as_string()->get();
      value = fs::absolute(folder / value).lexically_normal().string();
    }
  }
}

}  // namespace

Project read_project(const fs::path& path, Progress& progress) {
  Project project;
  project.table = parse_toml_file(path);
  project.inputs.push_back(path);
  TomlReader root(project.table, path.string(), "");
  const auto sources = root.tables("source");
  const auto reflectors = root.tables("reflector");
  const auto detectors = root.tables("detector");
  // What belongs to `design` alone is read there; here it is only known.
  root.has("target");
  root.has("design");
  root.finish();
  if (sources.empty()) root.fail("source", "is missing: a project needs at least one [[source]]");
  for (const TomlReader& reader : reflectors) project.scene.reflectors.push_back(read_reflector(reader));
  for (const TomlReader& reader : detectors) project.scene.far_fields.push_back(read_detector(reader));
  if (project.scene.far_fields.empty()) project.scene.far_fields.emplace_back();
  // Sources last: a wrong key anywhere is told before gigabytes are read.
  for (const TomlReader& reader : sources)
    project.scene.sources.push_back(read_source(reader, project, progress));
  try {
    check(project.scene);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
  make_files_absolute(project.table, fs::absolute(path).parent_path());
  return project;
}

std::string project_text(const Project& project) {
  std::ostringstream out;
  out << project.table << '\n';
  return out.str();
}

std::string project_template() {
  return R"(# A Lucerna project: which light falls on which mirror, and what is looked at.
# lucerna trace PROJECT.toml -o DIR
# Lengths in mm, angles in degrees, fluxes in lm (or W). Luminaire frame: z up, nadir (gamma 0) = -z, C0 = +x, C90 = +y.

[[source]]                    # any number of sources; their fluxes add
kind = "led"                  # an analytic emitter, or: file = "led.tm25ray"
# radius_mm, length_mm, size_mm = [x, y], surface = "sphere", surface_mm = 3.0: sizes of analytic emitters
flux_lm = 1000.0              # for a file: overrides what it states; flux_w for radiometric sources
position_mm = [0, 0, 0]       # where the source's origin goes
axis = "+z"                   # where its +z points: +x -x +y -y +z -z or a vector
turn_deg = 0.0                # then about that axis

[[reflector]]                 # in its own frame: vertex at the origin, opening along +z; then placed
family = "revolution"         # revolution, trough (along y), faceted (pitch_mm, pillow_radius_mm), bspline
preset = "parabola"           # parabola, ellipse, hyperbola; or profile_mm = [[r, z], ...], a spline
focal_mm = 15.0               # from the vertex; ellipse and hyperbola have focal2_mm too
aperture = "circle"           # circle: diameter_mm; rectangle: size_mm = [x, y]
diameter_mm = 100.0
hole_diameter_mm = 0.0
position_mm = [0, 0, 15]      # here: the focus is at the source
axis = "-z"                   # the mirror opens downward
turn_deg = 0.0
reflectance = 0.92            # or over the angle of incidence: [[0, 0.92], [60, 0.90], [85, 0.95]]
slope_error_mrad = 0.0        # Gaussian, standard deviation about each of two axes

[[detector]]
name = "far"                  # names the files
kind = "far-field"
c_step_deg = 5.0
gamma_step_deg = 1.0
)";
}

}  // namespace lucerna
