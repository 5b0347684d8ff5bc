// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/result_fields.h"

#include <fmt/format.h>

#include <array>

namespace lucerna {

namespace {

// clang-format off
constexpr std::array kFields{
    // path, of, type, unit, meaning
    ResultField{"program_version", "both", "text", "", "Version of the program."},
    ResultField{"schema_version", "both", "count", "", "Rises when a field changes its name or meaning."},
    ResultField{"command", "both", "text", "", "The command line."},
    ResultField{"seed", "both", "count", "", "Seed of the random numbers; null where none were drawn."},
    ResultField{"threads", "both", "count", "", "Worker threads."},
    ResultField{"isa", "both", "text", "", "Instruction set of the kernels that traced; `scalar` where none did."},
    ResultField{"device", "design", "text", "", "What evaluated the design."},
    ResultField{"inputs[].path", "both", "text", "", "A file that the result depends on."},
    ResultField{"inputs[].sha256", "both", "text", "", "Hash of its bytes."},
    ResultField{"wall_s.*", "both", "number", "s", "Time of a part of the run."},

    ResultField{"sequence", "trace", "text", "", "`sobol` or `random`."},
    ResultField{"rays.first", "trace", "count", "", "Number of the first ray."},
    ResultField{"rays.last", "trace", "count", "", "Number after the last ray."},
    ResultField{"warnings[]", "trace", "text", "", "What was odd in the files of the project, and what the figures and files may mislead about: a grid that is too coarse for the peak, mirrors that no light reaches."},
    ResultField{"ledger.unit", "trace", "text", "", "`lm` or `W`."},
    ResultField{"ledger.emitted", "trace", "number", "light", "Flux of all sources."},
    ResultField{"ledger.out_direct", "trace", "estimate", "light", "What leaves without a reflection."},
    ResultField{"ledger.out_reflected", "trace", "estimate", "light", "What leaves after at least one."},
    ResultField{"ledger.absorbed.*", "trace", "estimate", "light", "What a mirror's face (`mirror`), its back (`mirror_back`) or a body absorbs."},
    ResultField{"ledger.lost", "trace", "estimate", "light", "Rays that were given up."},
    ResultField{"ledger.lost_by_cause.*", "trace", "estimate", "light", "The same by cause."},
    ResultField{"ledger.rays", "trace", "count", "", "Rays traced."},
    ResultField{"ledger.lost_rays", "trace", "count", "", "Rays given up."},
    ResultField{"ledger.reflections_per_ray", "trace", "estimate", "", "Mean number of reflections."},

    ResultField{"detectors[].name", "trace", "text", "", "Names its files."},
    ResultField{"detectors[].kind", "trace", "text", "", "`far-field`, `plane`, `luminance` or `rays`."},
    ResultField{"detectors[].unit", "trace", "text", "", "Unit of its values."},
    ResultField{"detectors[].c_step_deg", "trace", "number", "degrees", "Far field: step of C."},
    ResultField{"detectors[].gamma_step_deg", "trace", "number", "degrees", "Far field: step of gamma."},
    ResultField{"detectors[].bins", "trace", "text", "", "Far field: `hard` or `tent`."},
    ResultField{"detectors[].flux", "trace", "estimate", "light", "All light that it recorded."},
    ResultField{"detectors[].peak.intensity", "trace", "estimate", "cd", "Far field: maximum of a local quadratic fit."},
    ResultField{"detectors[].peak.c_deg", "trace", "estimate", "degrees", "Its direction; null where it is not determined."},
    ResultField{"detectors[].peak.gamma_deg", "trace", "estimate", "degrees", "Its direction."},
    ResultField{"detectors[].peak.direction_error_deg", "trace", "number", "degrees", "Standard error of its direction on the sphere."},
    ResultField{"detectors[].peak.half_width_deg", "trace", "number", "degrees", "Half width of the lobe at half its peak, in its narrowest section."},
    ResultField{"detectors[].peak.fit_radius_deg", "trace", "number", "degrees", "Radius of the region of the fit; 0: exact, by light followed backward."},
    ResultField{"detectors[].peak.fit_radius_along_c_deg", "trace", "number", "degrees", "The same along C."},
    ResultField{"detectors[].centre.intensity", "trace", "estimate", "cd", "Intensity on the axis."},
    ResultField{"detectors[].centre.gamma_deg", "trace", "number", "degrees", "Which axis: 0 or 180."},
    ResultField{"detectors[].centre.fit_radius_deg", "trace", "number", "degrees", "Radius of the region of the fit; 0: exact, by light followed backward."},
    ResultField{"detectors[].planes[].c_deg", "trace", "number", "degrees", "The C plane of the angles that follow."},
    ResultField{"detectors[].planes[].beam_angle_of_maximum_deg", "trace", "estimate", "degrees", "Full angle in this plane above 50 % of the maximum of all."},
    ResultField{"detectors[].planes[].field_angle_of_maximum_deg", "trace", "estimate", "degrees", "Full angle in this plane above 10 % of the maximum of all."},
    ResultField{"detectors[].planes[].beam_angle_of_centre_deg", "trace", "estimate", "degrees", "Full angle above 50 % of the axis."},
    ResultField{"detectors[].planes[].field_angle_of_centre_deg", "trace", "estimate", "degrees", "Full angle above 10 % of the axis."},
    ResultField{"detectors[].cut_off_deg", "trace", "estimate", "degrees", "Largest angle from the axis at which 2.5 % of the peak are reached."},
    ResultField{"detectors[].zones.zonal[]", "trace", "estimate", "light", "Flux in zones of 10 degrees from nadir."},
    ResultField{"detectors[].zones.flux_0_30", "trace", "estimate", "light", "Flux at gamma 0 to 30 degrees."},
    ResultField{"detectors[].zones.flux_0_40", "trace", "estimate", "light", "Flux at gamma 0 to 40 degrees."},
    ResultField{"detectors[].zones.flux_0_60", "trace", "estimate", "light", "Flux at gamma 0 to 60 degrees."},
    ResultField{"detectors[].zones.flux_60_90", "trace", "estimate", "light", "Flux at gamma 60 to 90 degrees."},
    ResultField{"detectors[].zones.flux_0_90", "trace", "estimate", "light", "Flux into the lower half."},
    ResultField{"detectors[].zones.flux_90_180", "trace", "estimate", "light", "Flux into the upper half."},
    ResultField{"detectors[].zones.cie_flux_code[]", "trace", "estimate", "", "CIE flux code, N1 to N4 in per cent."},
    ResultField{"detectors[].zones.bug[]", "trace", "estimate", "light", "Flux in the ten solid angles that BUG ratings are made of (TM-15)."},
    ResultField{"detectors[].glare.radius_deg", "trace", "number", "degrees", "Radius of the fits of the glare intensities."},
    ResultField{"detectors[].glare.intensity[]", "trace", "estimate", "cd", "Intensity at gamma 45, 55, 65, 75, 85 in C0, then in C90."},
    ResultField{"detectors[].closure", "trace", "number", "", "Last factor on all values that made the flux exact: 1 within a per cent on a grid that resolves the beam."},
    ResultField{"detectors[].noise", "trace", "number", "", "Relative noise of all values, root mean square."},
    ResultField{"detectors[].node_noise", "trace", "number", "", "Largest error of a node above 1 % of the peak, as a share of the peak."},
    ResultField{"detectors[].position_mm", "trace", "number", "mm", "Plane, luminance: centre of the rectangle."},
    ResultField{"detectors[].normal", "trace", "number", "", "Plane, luminance: the side that is lit or looked at."},
    ResultField{"detectors[].up", "trace", "number", "", "Plane, luminance: the direction of +y."},
    ResultField{"detectors[].size_mm", "trace", "number", "mm", "Plane, luminance: sides of the rectangle."},
    ResultField{"detectors[].cells", "trace", "count", "", "Plane, luminance: cells along x and y."},
    ResultField{"detectors[].from_mm", "trace", "number", "mm", "Luminance: where a near observer is."},
    ResultField{"detectors[].pupil_radius_mm", "trace", "number", "mm", "Luminance: radius of that observer's pupil."},
    ResultField{"detectors[].half_angle_deg", "trace", "number", "degrees", "Luminance: half angle of the cone of a distant observer."},
    ResultField{"detectors[].mean", "trace", "estimate", "lx or cd/m2", "Plane, luminance: mean over the rectangle."},
    ResultField{"detectors[].min", "trace", "estimate", "lx or cd/m2", "Plane, luminance: minimum."},
    ResultField{"detectors[].uniformity", "trace", "estimate", "", "Plane: minimum over mean."},
    ResultField{"detectors[].peak.value", "trace", "number", "lx or cd/m2", "Plane, luminance: maximum."},
    ResultField{"detectors[].peak.standard_error", "trace", "number", "lx or cd/m2", "Its standard error."},
    ResultField{"detectors[].peak.x_mm", "trace", "number", "mm", "Its place."},
    ResultField{"detectors[].peak.y_mm", "trace", "number", "mm", "Its place."},
    ResultField{"detectors[].format", "trace", "text", "", "Rays: format of the file."},
    ResultField{"detectors[].file", "trace", "text", "", "Rays: name of the file."},
    ResultField{"detectors[].rays", "trace", "count", "", "Rays: how many were stored."},

    ResultField{"error.c12", "design", "box error", "", "Relative error in 12 x 12 boxes over the target's rectangle, root mean square. `excess` has the noise of counting (`floor`) taken out."},
    ResultField{"error.c24", "design", "box error", "", "The same in 24 x 24 boxes."},
    ResultField{"error.c48", "design", "box error", "", "The same in 48 x 48 boxes: the headline."},
    ResultField{"outside.share", "design", "estimate", "", "Share of the sources' light outside the target's rectangle."},
    ResultField{"outside.direct", "design", "estimate", "", "The part of it that met no mirror, or no face of the lens."},
    ResultField{"outside.error", "design", "box error", "", "Error outside the rectangle."},
    ResultField{"worst_cell", "design", "estimate", "", "Largest deviation of a box as a share of the brightest box of the target. Noise raises it."},
    ResultField{"bound.error", "design", "number", "", "No mirror of this aperture and height has a smaller error at this share of light: the larger of the next two."},
    ResultField{"bound.etendue_error", "design", "number", "", "By etendue and luminance of the sources."},
    ResultField{"bound.direct_error", "design", "number", "", "By the light that passes the mirror's rim unreflected."},
    ResultField{"bound.target_share", "design", "number", "", "Share of the target's light in its brightest boxes, which decide the bound."},
    ResultField{"bound.max_share", "design", "number", "", "Largest share of the sources' light that their etendue can hold."},
    ResultField{"bound.etendue_mm2sr", "design", "number", "mm2 sr", "That etendue."},
    ResultField{"bound.reason", "design", "text", "", "What decides the bound, in words."},
    ResultField{"start.**", "design", "group", "", "The same figures of what the search began with: the given mirror, or where limits exclude it one within them."},
    ResultField{"zones[].name", "design", "text", "", "A zone of the target."},
    ResultField{"zones[].verdict", "design", "text", "", "`missed` where any bound is, else `not determined` where any is, else `met`."},
    ResultField{"zones[].min", "design", "estimate", "cd or lx", "Its darkest measuring cell."},
    ResultField{"zones[].max", "design", "estimate", "cd or lx", "Its brightest measuring cell."},
    ResultField{"zones[].mean", "design", "estimate", "cd or lx", "Mean over its cells."},
    ResultField{"zones[].cells", "design", "count", "", "Measuring cells."},
    ResultField{"zones[].cell_deg", "design", "number", "degrees", "Side of a cell."},
    ResultField{"zones[].cell_mm", "design", "number", "mm", "Side of a cell on a plane."},
    ResultField{"zones[].bounds[].bound", "design", "text", "", "Key of the bound."},
    ResultField{"zones[].bounds[].allowed", "design", "number", "", "What the project allows."},
    ResultField{"zones[].bounds[].found", "design", "estimate", "", "The cell that is nearest to it."},
    ResultField{"zones[].bounds[].reference", "design", "number", "", "What a relative bound is a multiple of."},
    ResultField{"zones[].bounds[].place", "design", "text", "", "Where that cell is."},
    ResultField{"zones[].bounds[].missing", "design", "number", "", "What the cell is short of the bound, over the bound; negative where there is some to spare."},
    ResultField{"zones[].bounds[].verdict", "design", "text", "", "`met`, `missed` or `not determined` at this noise."},
    ResultField{"zones[].bounds[].direct", "design", "estimate", "", "Of upper bounds in cd or lx: the most light of any cell that met neither mirror nor body."},
    ResultField{"zones[].bounds[].broken_by_direct", "design", "flag", "", "Whether that light alone breaks the bound, which no mirror with this rim then keeps."},
    ResultField{"pareto[].light_weight", "design", "number", "", "Of a trade-off: the weight of light that the mirror was fitted with."},
    ResultField{"pareto[].vertex_moved_mm", "design", "number", "mm", "How far its vertex is from the given mirror's."},
    ResultField{"pareto[].error.**", "design", "group", "", "Its error, as above."},
    ResultField{"pareto[].in_rectangle", "design", "estimate", "", "Its light."},
    ResultField{"advice[].change", "design", "text", "", "Of advice: what was changed."},
    ResultField{"advice[].error.**", "design", "group", "", "What a design with it came to."},
    ResultField{"advice[].in_rectangle", "design", "estimate", "", "Its light."},
    ResultField{"advice[].helps", "design", "flag", "", "Whether it is better by more than three standard errors without loss of light."},
    ResultField{"in_rectangle", "design", "estimate", "", "Share of the sources' light in the target's rectangle, which holds 99.5 % of the target along each axis."},
    ResultField{"validation.rays", "design", "count", "", "Fresh rays that the error was measured with."},
    ResultField{"validation.seconds", "design", "number", "s", "How long that took."},
    ResultField{"bergen_fit", "design", "estimate", "", "Fit of the whole sphere, 100 is perfect; null for planes."},
    ResultField{"wasserstein_deg", "design", "estimate", "degrees", "How far light has to be moved; null for planes."},
    ResultField{"target.file", "design", "text", "", "The target."},
    ResultField{"target.mode", "design", "text", "", "`shape`, `absolute` or `zones`."},
    ResultField{"target.factor", "design", "number", "", "What the target is multiplied by to be compared."},
    ResultField{"target.peak.**", "design", "group", "", "Figures of the target, as of a detector."},
    ResultField{"target.centre.**", "design", "group", "", "The same on the axis."},
    ResultField{"target.planes[].**", "design", "group", "", "The same in C planes."},
    ResultField{"target.plane.**", "design", "group", "", "Minimum, mean, maximum and uniformity of a plane target."},
    ResultField{"peak.**", "design", "group", "", "Figures of the result, as of a detector."},
    ResultField{"centre.**", "design", "group", "", "The same on the axis."},
    ResultField{"planes[].**", "design", "group", "", "The same in C planes."},
    ResultField{"plane.**", "design", "group", "", "Minimum, mean, maximum and uniformity on a plane target's rectangle."},
    ResultField{"scale", "design", "number", "", "Factor between result and target, 1 with mode absolute."},
    ResultField{"efficiency", "design", "estimate", "", "Share of the sources' flux that leaves."},
    ResultField{"losses.mirror", "design", "estimate", "", "Share that the mirror's face absorbs."},
    ResultField{"losses.mirror_back", "design", "estimate", "", "Share that its back absorbs."},
    ResultField{"losses.bodies", "design", "estimate", "", "Share that bodies absorb."},
    ResultField{"losses.lost", "design", "estimate", "", "Share of rays that were given up."},
    ResultField{"evaluations", "design", "count", "", "Evaluations of a mirror."},
    ResultField{"rays", "design", "count", "", "Rays traced by them."},
    ResultField{"parameters", "design", "count", "", "Parameters of the mirror."},
    ResultField{"height_mm", "design", "number", "mm", "Height of the mirror."},
    ResultField{"limits[].limit", "design", "text", "", "A limit of the project."},
    ResultField{"limits[].allowed", "design", "number", "", "What is allowed."},
    ResultField{"limits[].found", "design", "estimate", "", "What the exported mesh and its light have."},
    ResultField{"limits[].held", "design", "flag", "", "Whether it is held."},
    ResultField{"tolerances.source_shift_mm", "design", "number", "mm", "Of a tolerance sweep: the ranges of the project."},
    ResultField{"tolerances.source_tilt_deg", "design", "number", "degrees", "The same."},
    ResultField{"tolerances.slope_error_mrad", "design", "number", "mrad", "The same."},
    ResultField{"tolerances.reflectance", "design", "number", "", "The same."},
    ResultField{"tolerances.samples", "design", "count", "", "Combined cases."},
    ResultField{"tolerances.rays", "design", "count", "", "Rays of each case."},
    ResultField{"tolerances.spread.*.nominal", "design", "estimate", "", "A figure of the design itself."},
    ResultField{"tolerances.spread.*.mean", "design", "estimate", "", "Its mean over the combined cases."},
    ResultField{"tolerances.spread.*.standard_deviation", "design", "estimate", "", "Its spread."},
    ResultField{"tolerances.spread.*.min", "design", "estimate", "", "Its minimum."},
    ResultField{"tolerances.spread.*.max", "design", "estimate", "", "Its maximum."},
    ResultField{"tolerances.spread.*.cases", "design", "count", "", "Combined cases in which it is determined."},
    ResultField{"tolerances.cases[].**", "design", "group", "", "Each case: what was changed and the figures then."},
    ResultField{"lens", "design", "flag", "", "True where a lens was shaped; absent for mirrors."},
    ResultField{"end", "design", "text", "", "Why the search ended: converged, time, interrupted."},
    ResultField{"remarks[]", "design", "text", "", "What is known of why the error is not smaller."},
};
// clang-format on

constexpr std::string_view kHead = R"(# Results as JSON

`trace`, `merge`, `design` and `compare` write `result.json` into their folder. `--json` prints it
instead of text. `info`, `check`, `compress` and `bench` only print theirs.

- An *estimate* is an object with `value` and `standard_error`.
- A *box error* has `value`, `floor` (the noise of counting), `excess` (the value without the floor)
  and `standard_error` of the excess.
- A figure that is not determined is `null`.
- `[]` means each item of an array, `*` for a name that follows from the input, `**` for all
  fields below.
- The unit "light" is that of the sources' flux, lm or W. With watts, cd is W/sr and lx is W/m2.
- A design's file has the fields of a trace as well, except `sequence` and `rays`: they are of the
  final trace of its mirror.

This page is written by `make reference` from the tables that tests compare with real output.
)";

std::string_view first_part(std::string_view path) { return path.substr(0, path.find('.')); }
std::string_view rest(std::string_view path) {
  const std::size_t dot = path.find('.');
  return dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
}

std::string section(std::string_view of, std::string_view title) {
  std::string text = fmt::format("\n## {}\n\n| field | type | unit | meaning |\n|---|---|---|---|\n", title);
  for (const auto& fields : {result_fields(), command_fields()}) {
    for (const ResultField& f : fields) {
      if (f.of == of) text += fmt::format("| `{}` | {} | {} | {} |\n", f.path, f.type, f.unit, f.meaning);
    }
  }
  return text;
}

}  // namespace

std::span<const ResultField> result_fields() { return kFields; }

bool stands_for(std::string_view pattern, std::string_view path) {
  if (pattern == "**") return !path.empty();
  if (pattern.empty() || path.empty()) return pattern.empty() && path.empty();
  const std::string_view wanted = first_part(pattern);
  return (wanted == "*" || wanted == first_part(path)) && stands_for(rest(pattern), rest(path));
}

std::string result_reference() {
  std::string text = std::string(kHead) + section("both", "Every run") + section("trace", "trace, merge");
  for (const char* command : {"design", "compare", "info", "check", "compress", "bench"})
    text += section(command, command);
  return text;
}

}  // namespace lucerna
