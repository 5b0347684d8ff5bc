// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/problem/design_detectors.h"
#include "lucerna/design/run/search_mirror.h"
#include "lucerna/optics/shapes/profile.h"
#include "lucerna/optics/shapes/trough_surface.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/schema/toml_reader.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Between the direction that a mirror opens in and the axis of the luminaire nearest to its target's light.
constexpr double kMaxOpening_deg = 120.0;

/// The paraboloid nearest to a profile: z - z(0) = r^2 / (4 f) in the least-squares sense.
double nearest_focal(const Profile& profile, double radius) {
  double r4 = 0.0, r2z = 0.0;
  for (int i = 1; i <= 200; ++i) {
    const double r = radius * i / 200.0;
    r4 += r * r * r * r;
    r2z += r * r * (profile.at(r).z_mm - profile.at(0.0).z_mm);
  }
  if (!(r2z > 0.0)) throw InputError("design: the reflector to begin with does not open along its +z");
  return 0.25 * r4 / r2z;
}

DesignShape start_shape(const Reflector& reflector, const std::vector<int>& intervals, TomlReader& reader,
                        ShapeSymmetry symmetry) {
  if (const auto* s = dynamic_cast<const RevolutionSurface*>(reflector.surface.get())) {
    const double radius = reflector.aperture.outer_radius_mm();
    const int n = intervals.empty() ? 16 : intervals[0];
    if (reflector.aperture.shape() != ApertureShape::circle) {
      reader.fail("intervals", "family = \"revolution\" is designed over aperture = \"circle\" only");
    }
    const DesignShape plain =
        DesignShape::revolution(nearest_focal(s->profile(), radius), reflector.aperture, n);
    return plain.through([&](double x, double y) { return s->profile().at(std::hypot(x, y)).z_mm; });
  }
  if (const auto* s = dynamic_cast<const TroughSurface*>(reflector.surface.get())) {
    const Aperture& a = reflector.aperture;
    const bool mirrored = symmetry == ShapeSymmetry::mirror_x || symmetry == ShapeSymmetry::both;
    const DesignShape plain = DesignShape::trough(nearest_focal(s->profile(), a.half_x_mm()), a,
                                                  intervals.empty() ? 12 : intervals[0], mirrored);
    return plain.through([&](double x, double y) { return s->at(x, y).z_mm; });
  }
  const auto* s = dynamic_cast<const SmoothSurface<BsplineShape>*>(reflector.surface.get());
  if (s == nullptr) reader.fail("intervals", "this reflector family cannot be designed");
  const BsplineShape& shape = s->shape();
  // A mirror that comes with knots of its own keeps them: coarser ones would not be what was given.
  const int nx = intervals.empty() ? std::max(kFreeFormIntervals, shape.row_x().intervals) : intervals[0];
  const int ny = intervals.empty() ? std::max(kFreeFormIntervals, shape.row_y().intervals)
                                   : (intervals.size() > 1 ? intervals[1] : nx);
  const DesignShape plain = DesignShape::bspline(shape.focal_mm(), reflector.aperture, nx, ny, symmetry);
  return plain.through([&](double x, double y) { return smooth_point(shape.view(), x, y).z_mm; });
}

std::vector<int> read_intervals(TomlReader& reader) {
  std::vector<int> out;
  for (const double n : reader.number_or_numbers("intervals").value_or(std::vector<double>())) {
    if (out.size() == 2) reader.fail("intervals", "found more than two numbers, expected one or two");
    out.push_back(static_cast<int>(n));
  }
  return out;
}

/// Restarts in a row that may gain nothing where the project does not say: as many as there is time for.
constexpr int kMaxFailedRestarts = 1'000'000;

std::optional<int> read_restarts(TomlReader& reader) {
  const std::optional<double> n = reader.number("restarts");
  if (!n) return std::nullopt;
  return static_cast<int>(*n);
}

/// How often the knots may be doubled, 0 where the project says how many: bins hold about four numbers for
/// each parameter then.
int doublings(const DesignShape& shape, int bins, bool given_restarts) {
  if (given_restarts || shape.is_revolution()) return 0;
  const int across = std::max(shape.intervals_x(), shape.intervals_y());
  const double share = shape.symmetry() == ShapeSymmetry::both ? 0.25 : 1.0;
  int n = 0;
  while (share * std::pow((across << (n + 1)) + 3, 2) <= 0.25 * bins * bins) ++n;
  return n;
}

/// Least height of the rays' beginnings over a shape; of those that `given` has in front of itself.
double clearance_mm(const DesignShape& shape, const DesignShape& given, const DesignRays& rays) {
  double min = std::numeric_limits<double>::infinity();
  for (std::uint64_t b = 0; b < rays.size() / kBlockRays; ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const auto x = static_cast<double>(block.x_mm[i]), y = static_cast<double>(block.y_mm[i]);
      const auto z = static_cast<double>(block.z_mm[i]);
      if (!given.aperture().contains(x, y) || z < given.at(x, y).z_mm) continue;
      min = std::min(min, z - shape.at(x, y).z_mm);
    }
  }
  return min;
}

/// Limits on the form say nothing of where the mirror is: a flatter one must not rise past the source. `held`
/// is moved along the axis until it is as far from the source as `given` is.
DesignShape in_front_of_source(const DesignShape& given, const DesignShape& held, DesignRays rays) {
  rays.grow(std::uint64_t{1} << 14);
  const double rise = clearance_mm(given, given, rays) - clearance_mm(held, given, rays);
  if (!(rise > 0.0)) return held;
  return held.with((held.parameters().array() - rise).matrix());
}

Optimizer read_optimizer(TomlReader& design) { return optimizer(design.word("optimizer").value_or("auto")); }

/// The reflector that is to be shaped becomes the first, in the scene and in the project's tables.
void put_shaped_first(Project& project, const TomlReader& root, TomlReader& design) {
  std::vector<PlacedReflector>& all = project.scene.reflectors;
  const std::optional<double> number = design.number("reflector");
  if (all.empty())
    root.fail("reflector",
              "found no reflector, expected the one that is to be shaped; of a lens, `free_sides` "
              "in [design] says what is");
  if (!number && all.size() == 1) return;
  const auto count = static_cast<double>(all.size());
  if (!number) {
    design.fail("reflector",
                fmt::format("is missing: found {} reflectors, expected the number (from 0) of the "
                            "one that is to be shaped",
                            all.size()));
  }
  if (!(*number >= 0.0 && *number < count && *number == std::floor(*number))) {
    design.fail("reflector",
                fmt::format("found {}, expected a whole number from 0 to {}", *number, count - 1.0));
  }
  const auto shaped = static_cast<std::ptrdiff_t>(*number);
  std::rotate(all.begin(), all.begin() + shaped, all.begin() + shaped + 1);
  const toml::array given = *toml_tables(project)["reflector"].as_array();
  toml::array ordered{*given.get(static_cast<std::size_t>(shaped))->as_table()};
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (i != static_cast<std::size_t>(shaped)) ordered.push_back(*given.get(i)->as_table());
  }
  toml_tables(project).insert_or_assign("reflector", std::move(ordered));
  toml_tables(project)["design"].as_table()->insert_or_assign("reflector", 0);
}

/// Zones are fitted by the search of free forms alone.
void check_zones_family(const TomlReader& root, const DesignProblem& problem) {
  const DesignShape& start = problem.start;
  if (problem.target.zones == nullptr || (uses_free_form_search(problem) && !start.is_trough())) return;
  const std::string found = start.is_revolution() ? "family = \"revolution\""
                            : start.is_trough()   ? "family = \"trough\""
                                                  : fmt::format("optimizer = \"{}\"", problem.optimizer.name);
  root.fail("target", fmt::format("found {}: zones are designed for free forms only, expected family = "
                                  "\"bspline\" and optimizer = \"auto\"",
                                  found));
}

/// The search and its validation know no refraction: said before the time is spent.
void check_clear(const TomlReader& root, const Scene& scene) {
  if (scene.glasses.empty() && scene.solids.empty()) return;
  const std::string& name = scene.glasses.empty() ? scene.solids.front().name : scene.glasses.front().name;
  root.fail("body",
            fmt::format("found '{}', which light passes: expected none in a design; a trace of the result "
                        "takes it",
                        name),
            ErrorCause::unsupported);
}

/// A mirror sends no light out of its back: refuses a target that lies there, where nothing else could turn
/// the light around.
void check_opening(const TomlReader& root, const DesignProblem& problem) {
  const Scene& scene = problem.project.scene;
  const bool others = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                  [](const Body& b) { return b.reflectance.max() > 0.0; });
  if (scene.reflectors.size() > 1 || others) return;
  const Vec3 light = target_rectangle(problem.target.distribution).world_from_rectangle.ez();
  const double angle_deg =
      degrees(std::acos(std::clamp(dot(light, problem.world_from_mirror.ez()), -1.0, 1.0)));
  if (angle_deg <= kMaxOpening_deg) return;
  root.fail(
      "target",
      fmt::format("the target's light goes {:.0f} degrees away from where the mirror opens, expected the "
                  "mirror's `axis` towards the target",
                  angle_deg),
      ErrorCause::contradiction);
}

}  // namespace

DesignShape start_within(const DesignLimits& limits, const DesignShape& start,
                         const std::vector<PlacedSource>& sources, const Frame& world_from_mirror) {
  const DesignShape held = ShapeLimits(limits, start).nearest(start);
  if (held.parameters() == start.parameters()) return start;
  const DesignShape moved =
      in_front_of_source(start, held, DesignRays(sources, world_from_mirror.inverse(), 1));
  return ShapeLimits(limits, moved).nearest(moved);
}

DesignProblem design_problem(Project project, const std::filesystem::path& path) {
  // The readers below point into it. It stays where it is when the project is moved; a copy has no lines.
  const toml::table& tables = toml_tables(project);
  TomlReader root(tables, path.string(), "");
  for (const char* known : {"source", "reflector", "body"}) root.has(known);
  check_detector_names(root, "reflector");
  auto target_reader = root.table("target");
  auto reader = root.table("design");
  root.finish();
  if (!target_reader) root.missing("target", "a design needs a [target]");
  static const toml::table kNothing;
  TomlReader design = reader ? *reader : TomlReader(kNothing, path.string(), "design");
  put_shaped_first(project, root, design);
  const Optimizer how = read_optimizer(design);
  const double time_s = design.number("time_s", 60.0);
  const std::vector<int> intervals = read_intervals(design);
  const std::optional<int> given_restarts = read_restarts(design);
  const double light_weight = design.number("light_weight", kLightWeight);
  const PlacedReflector placed = project.scene.reflectors[0];
  const bool revolution = dynamic_cast<const RevolutionSurface*>(placed.reflector.surface.get()) != nullptr;
  const int max_failed_restarts = given_restarts.value_or(kMaxFailedRestarts);
  const double source_flux = total_flux(project.scene.sources);
  DesignLimits limits;
  if (auto table = design.table("limits")) {
    limits = read_limits(std::move(*table), placed.reflector.aperture, revolution,
                         placed.world_from_reflector, project.scene.bodies, source_flux);
  }
  DesignTarget target = read_target(*target_reader, project.scene.sources.front().rays->flux_unit(),
                                    source_flux, placed.world_from_reflector.origin_mm(), project);
  DesignShape start = start_shape(placed.reflector, intervals, design, limits.symmetry);
  std::optional<ToleranceRanges> tolerances;
  if (auto table = design.table("tolerances")) tolerances = read_tolerances(std::move(*table));
  design.finish();
  start = start_within(limits, start, project.scene.sources, placed.world_from_reflector);
  const int knot_doublings = doublings(start, WindowOptions().count, !intervals.empty());
  add_design_detectors(project, target);
  DesignProblem problem{std::move(project),
                        std::move(target),
                        std::move(limits),
                        std::move(start),
                        placed.reflectance,
                        placed.world_from_reflector,
                        time_s,
                        how,
                        max_failed_restarts,
                        knot_doublings,
                        !intervals.empty(),
                        light_weight,
                        tolerances};
  check_zones_family(root, problem);
  check_opening(root, problem);
  check_clear(root, problem.project.scene);
  return problem;
}

TentBins target_window(const DesignProblem& problem) {
  return target_bins(problem.target, problem.world_from_mirror, problem.start.is_revolution());
}

namespace {

/// A line of the given mirror that is not its shape; empty if it has none.
std::string given_key(const DesignProblem& problem, const char* key) {
  const auto* reflectors = toml_tables(problem.project)["reflector"].as_array();
  const auto* table = reflectors != nullptr ? reflectors->get(0)->as_table() : nullptr;
  const auto* node = table != nullptr ? table->get(key) : nullptr;
  if (node == nullptr) return "";
  std::ostringstream out;
  if (const toml::table* given = node->as_table()) {
    toml::table on_one_line = *given;
    on_one_line.is_inline(true);
    out << on_one_line;
  } else {
    node->visit([&](const auto& n) { out << n; });
  }
  return fmt::format("{} = {}\n", key, out.str());
}

}  // namespace

std::string reflector_toml(const DesignProblem& problem, const DesignShape& shape) {
  const Aperture& aperture = shape.aperture();
  std::string text = "[[reflector]]\n";
  if (shape.is_revolution()) {
    // The given points of a C2 spline with its last interval halved: not-a-knot makes the same curve of them.
    const int n = shape.intervals_x();
    const double radius = aperture.outer_radius_mm();
    text += "family = \"revolution\"\nprofile_mm = [\n";
    for (int i = 0; i <= n + 1; ++i) {
      const double share = i < n ? i : (i == n ? n - 0.5 : n);
      const double r = i == n + 1 ? radius : radius * share / n;
      text += fmt::format("  [{}, {}],\n", r, shape.at(r, 0.0).z_mm);
    }
    text += "]\n";
  } else {
    const auto& s = std::get<BsplineShape>(shape.family());
    text += fmt::format("family = \"bspline\"\nfocal_mm = {}\nintervals = [{}, {}]\ncoefficients_mm = [",
                        s.focal_mm(), s.row_x().intervals, s.row_y().intervals);
    for (std::size_t i = 0; i < s.coefficients().size(); ++i) {
      text += fmt::format("{}{}", i == 0 ? "\n  " : (i % 4 == 0 ? ",\n  " : ", "), s.coefficients()[i] + 0.0);
    }
    text += "\n]\n";
  }
  if (aperture.shape() == ApertureShape::circle) {
    text += fmt::format("aperture = \"circle\"\ndiameter_mm = {}\n", 2.0 * aperture.half_x_mm());
  } else {
    text += fmt::format("aperture = \"rectangle\"\nsize_mm = [{}, {}]\n", 2.0 * aperture.half_x_mm(),
                        2.0 * aperture.half_y_mm());
  }
  text += fmt::format("hole_diameter_mm = {}\n", 2.0 * aperture.hole_radius_mm());
  for (const char* key : {"position_mm", "axis", "turn_deg", "reflectance", "metal", "wavelength_nm",
                          "slope_error_mrad", "scatter", "data_sheet", "bsdf"}) {
    text += given_key(problem, key);
  }
  return text;
}

Project with_shape(const DesignProblem& problem, const DesignShape& shape) {
  Project project = problem.project;
  project.scene.reflectors[0].reflector = shape.reflector();
  const toml::table tables = toml::parse(reflector_toml(problem, shape));
  toml::array reflectors = *tables["reflector"].as_array();
  const toml::array& given = *toml_tables(problem.project)["reflector"].as_array();
  for (std::size_t i = 1; i < given.size(); ++i) reflectors.push_back(*given.get(i)->as_table());
  toml_tables(project).insert_or_assign("reflector", std::move(reflectors));
  return project;
}

}  // namespace lucerna
