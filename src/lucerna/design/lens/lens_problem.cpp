// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/lens/entry_face.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/problem/design_detectors.h"
#include "lucerna/design/problem/design_limits.h"
#include "lucerna/design/problem/target_rectangle.h"
#include "lucerna/design/validation/error_boxes.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/schema/toml_reader.h"

namespace lucerna {

namespace {

/// Share of a target's light behind the lens below which none of it is fitted: it is what surfaces reflect
/// by Fresnel's formulas, most of it. The error has no box there, and light that goes to and fro within a
/// lens until it leaves behind makes steps short: its derivatives are a hundred times what a step changes.
constexpr double kLittleBehind = 0.2;

/// A lens alone: what else light could meet is refused before the time is spent.
void check_alone(const TomlReader& root, const Scene& scene) {
  if (!scene.reflectors.empty())
    root.fail("reflector", "found one beside a lens that is to be shaped, expected none",
              ErrorCause::unsupported);
  if (!scene.bodies.empty() || !scene.glasses.empty())
    root.fail("body", "found another body beside the lens that is to be shaped, expected none",
              ErrorCause::unsupported);
  if (scene.solids.size() != 1 || scene.solids.front().outline_mm.empty()) {
    root.fail("body",
              fmt::format("found {} solids{}, expected one with `outline_mm`, whose `free_sides` are "
                          "shaped",
                          scene.solids.size(), scene.solids.empty() ? "" : ", of triangles or several"),
              ErrorCause::unsupported);
  }
  if (!scene.solids.front().scatter_sides.empty())
    root.fail("body",
              "found `scatter_sides` of a lens that is to be shaped, expected lobes on all of it or none",
              ErrorCause::unsupported);
  if (scene.solids.front().face) {
    root.fail("body",
              "found a solid with a [body.face], expected one of revolution, whose `free_sides` are shaped",
              ErrorCause::unsupported);
  }
}

std::vector<std::size_t> read_sides(TomlReader& design) {
  std::vector<std::size_t> out;
  for (const double number : design.number_or_numbers("free_sides").value_or(std::vector<double>())) {
    const auto side = static_cast<std::size_t>(number);
    if (std::ranges::find(out, side) != out.end())
      design.fail("free_sides", fmt::format("found side {} twice, expected each once", side));
    out.push_back(side);
  }
  return out;
}

/// 0 where the project does not say.
int read_lens_intervals(TomlReader& design) {
  const auto given = design.number_or_numbers("intervals");
  if (!given) return 0;
  if (given->size() != 1) design.fail("intervals", "expected one number for the faces of a lens");
  if (given->front() < 3.0) design.fail("intervals", "expected at least 3 for the faces of a lens");
  return static_cast<int>(given->front());
}

/// What `family` makes of the free face.
std::optional<FreeFaceProblem> read_free_face(TomlReader& design, int intervals) {
  const std::string family = design.word("family").value_or("revolution");
  const std::string entry = design.word("entry").value_or("cavity");
  if (family == "revolution") {
    if (design.has("entry")) design.fail("entry", "belongs to family = \"bspline\"; this is \"revolution\"");
    return std::nullopt;
  }
  if (family != "bspline")
    design.fail("family", fmt::format("found \"{}\", expected \"revolution\" or \"bspline\"", family));
  FreeFaceProblem out;
  if (intervals > 0) out.intervals = out.max_intervals = intervals;
  out.entry = entry == "bspline" ? EntryKind::bspline : EntryKind::cavity;
  return out;
}

LensLimits read_lens_limits(TomlReader reader, bool revolution, const Frame& world_from_lens) {
  LensLimits limits;
  limits.max_diameter_mm = reader.number("max_diameter_mm");
  limits.max_height_mm = reader.number("max_height_mm");
  limits.min_thickness_mm = reader.number("min_thickness_mm");
  limits.min_draft_deg = reader.number("min_draft_deg");
  for (const char* key : {"min_opening_mm", "min_hole_diameter_mm", "max_slope_deg", "min_radius_mm",
                          "min_efficiency", "body_clearance_mm", "keep_out", "glare"}) {
    if (reader.has(key))
      reader.fail(key,
                  "is a limit on mirrors; a lens has max_diameter_mm, max_height_mm, min_thickness_mm, "
                  "min_draft_deg and symmetry");
  }
  if (limits.min_thickness_mm && limits.max_height_mm && *limits.min_thickness_mm > *limits.max_height_mm) {
    reader.fail(
        "min_thickness_mm",
        fmt::format("= {} contradicts max_height_mm = {}", *limits.min_thickness_mm, *limits.max_height_mm),
        ErrorCause::contradiction);
  }
  limits.symmetry = read_symmetry(reader, revolution, world_from_lens);
  reader.finish();
  return limits;
}

/// Refuses limits that no face of the lens holds.
void check_free_face(const LensShape& lens, int intervals, const LensLimits& limits) {
  const DesignShape face = face_of(lens, intervals, limits.symmetry);
  const FaceSeat seat = face_seat(lens);
  const auto held = face_limits(limits, seat, face, kCheckRings).held_nearby(face);
  std::string broken;
  for (const LimitCheck& check : check_face_limits(limits, seat, held.value_or(face))) {
    if (!check.held)
      broken += fmt::format("{}{} = {} ({:.4g} found)", broken.empty() ? "" : ", ", check.limit,
                            check.allowed, check.found.mean);
  }
  if (!held || !broken.empty())
    throw InputError("no face over this base was found that holds [design.limits]: " + broken,
                     ErrorCause::contradiction);
}

/// The faces of a lens by what becomes of them: those that begin on the axis below are entries.
struct FreeSides {
  std::vector<std::size_t> entry, others;
};

FreeSides sorted_sides(const Solid& solid, const std::vector<std::size_t>& sides) {
  FreeSides out;
  for (const std::size_t side : sides) {
    const LensShape one(solid.outline_mm, solid.smooth_below_deg, std::vector<std::size_t>{side}, 0);
    const LensForm& form = one.form();
    const OutlineRun& run = form.faces[form.free_faces().front()].run;
    const bool is_entry = form.corners[corner_number(form, run.from)][0] == 0.0;
    (is_entry ? out.entry : out.others).push_back(side);
  }
  return out;
}

/// The lens that a design begins with. Where a free form has an entry that is free, only the other face
/// remains free in it.
LensShape lens_to_begin_with(const Solid& solid, const std::vector<std::size_t>& sides, int intervals,
                             const LensLimits& limits, std::optional<FreeFaceProblem>& free_face) {
  if (!free_face) return {solid.outline_mm, solid.smooth_below_deg, sides, intervals};
  const FreeSides sorted = sorted_sides(solid, sides);
  const bool shapes_entry = !sorted.entry.empty() && !sorted.others.empty();
  if (!shapes_entry) {
    if (free_face->entry == EntryKind::bspline)
      throw InputError("entry = \"bspline\": found no side from the axis to the base among them");
    free_face->entry = EntryKind::given;
  }
  LensShape shape(solid.outline_mm, solid.smooth_below_deg, shapes_entry ? sorted.others : sides, 0);
  check_free_face(shape, free_face->intervals, limits);
  if (shapes_entry) static_cast<void>(cavity_range(shape, limits));
  return shape;
}

/// Refuses a plane that the lens reaches.
void check_before_plane(const TomlReader& reader, const DesignTarget& target, const Solid& solid) {
  if (!target.plane) return;
  const Frame plane_from_solid = target.plane->world_from_plane.inverse() * solid.world_from_solid;
  const double tilt = std::hypot(plane_from_solid.ex().z, plane_from_solid.ey().z);
  double behind_mm = -std::numeric_limits<double>::infinity();
  for (const auto& [radius, z] : solid.outline_mm)
    behind_mm = std::max(behind_mm, radius * tilt - plane_from_solid.point({0.0, 0.0, z}).z);
  if (behind_mm < 0.0) return;
  reader.fail("position_mm",
              fmt::format("the lens reaches the plane; expected it to lie wholly before the lit "
                          "side, found it up to {:.4g} mm behind",
                          behind_mm));
}

/// A face as [body.face] has it.
toml::table face_table(const DesignShape& face) {
  const FaceSpline spline = face_spline(face);
  toml::array coefficients;
  for (const double c : spline.coefficients_mm) coefficients.push_back(c + 0.0);
  return toml::table{{"half_mm", spline.half_mm},
                     {"intervals", toml::array{spline.intervals_x, spline.intervals_y}},
                     {"coefficients_mm", std::move(coefficients)}};
}

/// The [[body]] of the lens: the project's only one.
toml::table& lens_table(Project& project) {
  return *toml_tables(project)["body"].as_array()->get(0)->as_table();
}

DesignTarget target_of_lens(TomlReader& reader, Project& project) {
  const Scene& scene = project.scene;
  return read_target(reader, scene.sources.front().rays->flux_unit(), total_flux(scene.sources),
                     scene.solids.front().world_from_solid.origin_mm(), project);
}

}  // namespace

bool is_lens_design(const Project& project) {
  const toml::table* const design = toml_tables(project)["design"].as_table();
  return design != nullptr && design->contains("free_sides");
}

bool is_finished_lens(const Project& project) {
  const toml::table& tables = toml_tables(project);
  return tables.contains("target") && !tables.contains("design") && project.scene.solids.size() == 1 &&
         project.scene.solids.front().face != nullptr;
}

DesignTarget finished_lens_target(Project& project, const std::filesystem::path& path) {
  // A copy: reading the target adds to the project.
  const toml::table tables = toml_tables(project);
  TomlReader root(tables, path.string(), "");
  auto reader = root.table("target");
  return target_of_lens(*reader, project);
}

LensProblem lens_problem(Project project, const std::filesystem::path& path) {
  const toml::table& tables = toml_tables(project);
  TomlReader root(tables, path.string(), "");
  for (const char* known : {"source", "reflector", "body"}) root.has(known);
  check_detector_names(root, "lens");
  auto target_reader = root.table("target");
  auto design = root.table("design");
  root.finish();
  if (!target_reader) root.missing("target", "a design needs a [target]");
  if (!design) root.missing("design", "a lens needs `free_sides` there");
  check_alone(root, project.scene);
  const Solid& solid = project.scene.solids.front();
  const auto sides = read_sides(*design);
  const int intervals = read_lens_intervals(*design);
  auto free_face = read_free_face(*design, intervals);
  const double light_weight = design->number("light_weight", kLightWeight);
  const double time_s = design->number("time_s", 60.0);
  const double restarts = design->number("restarts", 1e6);
  const std::string optimizer = design->word("optimizer").value_or("auto");
  if (optimizer != "auto" && optimizer != "least-squares")
    design->fail("optimizer", fmt::format("found \"{}\": a lens is designed by \"auto\"", optimizer));
  for (const char* key : {"reflector", "tolerances"}) {
    if (design->has(key)) design->fail(key, "belongs to the design of a mirror; this is a lens");
  }
  LensLimits limits;
  if (auto table = design->table("limits"))
    limits = read_lens_limits(std::move(*table), !free_face, solid.world_from_solid);
  design->finish();
  const LensShape start = [&] {
    try {
      return lens_to_begin_with(solid, sides, intervals, limits, free_face);
    } catch (const InputError& e) {
      design->fail("free_sides", e.what());
    }
  }();
  DesignTarget target = target_of_lens(*target_reader, project);
  check_before_plane(*target_reader, target, solid);
  if (target.zones != nullptr)
    root.fail("target", "found zones, which only free-form mirrors are designed for");
  const MediumView medium{solid.refractive_index, solid.absorption_per_mm};
  const Frame placed = solid.world_from_solid;
  add_design_detectors(project, target);
  return {std::move(project),
          std::move(target),
          limits,
          start,
          medium,
          placed,
          free_face,
          light_weight,
          time_s,
          static_cast<int>(restarts)};
}

double target_share_within(const LensProblem& problem, double gamma_rad) {
  const Direction axis = problem.world_from_lens.direction(Direction());
  double within = 0.0, all = 0.0;
  for (const DirectedFlux& light : directed_flux(problem.target.distribution)) {
    all += light.flux;
    if (angle_between(light.direction, axis) <= gamma_rad) within += light.flux;
  }
  return within / all;
}

TentBins lens_window(const LensProblem& problem) {
  constexpr double kAligned = 1.0 - 1e-12;
  constexpr int kRingsOfBox = 2;
  /// The window of a narrow beam is wide all the same, where there is much light behind.
  constexpr double kMostRings = 1024.0;
  const bool rotational = !problem.target.plane && problem.target.distribution.c_deg.size() == 1 &&
                          std::abs(problem.world_from_lens.ez().z) > kAligned;
  if (!rotational) return lens_boxes(problem);
  TentBins bins = target_bins(problem.target, problem.world_from_lens, true);
  constexpr double kHemisphere = 0.5 * std::numbers::pi;
  if (bins.extent() > kHemisphere && target_share_within(problem, kHemisphere) > 1.0 - kLittleBehind)
    bins = TentBins::rings(bins.axes(), kHemisphere, bins.count());
  const double box = target_rectangle(problem.target).width() / kErrorBoxes;
  const double rings = std::clamp(std::ceil(kRingsOfBox * bins.extent() / box), 48.0, kMostRings);
  return rebinned(bins, 1.0, static_cast<int>(rings));
}

TentBins lens_boxes(const LensProblem& problem) {
  return target_bins(problem.target, problem.world_from_lens, false);
}

Solid shaped_solid(const LensProblem& problem, const ShapedLens& lens) {
  Solid solid = problem.project.scene.solids.front();
  if (lens.face) return with_face(solid, seat_of(lens), *lens.face);
  solid.outline_mm = lens.outline.corners();
  return solid;
}

Project with_lens(const LensProblem& problem, const ShapedLens& lens) {
  Project project = problem.project;
  project.scene.solids.front() = shaped_solid(problem, lens);
  toml::array outline;
  for (const OutlinePoint& p : project.scene.solids.front().outline_mm)
    outline.push_back(toml::array{p[0] + 0.0, p[1] + 0.0});
  lens_table(project).insert_or_assign("outline_mm", std::move(outline));
  auto* const design = toml_tables(project)["design"].as_table();
  if (lens.face) {
    lens_table(project).insert_or_assign("face", face_table(*lens.face));
    if (lens.entry) lens_table(project).insert_or_assign("bottom_face", face_table(*lens.entry));
    // A lens with such a face is not one to begin with.
    if (design != nullptr) toml_tables(project).erase("design");
  } else if (design != nullptr) {
    // Sides have other numbers now: those of the shaped faces.
    toml::array sides;
    for (const LensFace& face : lens.outline.form().faces) {
      if (face.is_free)
        sides.push_back(static_cast<std::int64_t>(corner_number(lens.outline.form(), face.run.from)));
    }
    design->insert_or_assign("free_sides", std::move(sides));
    design->erase("intervals");
  }
  return project;
}

}  // namespace lucerna
