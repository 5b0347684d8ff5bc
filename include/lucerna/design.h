// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/progress.h"
#include "lucerna/project.h"
#include "lucerna/reflector.h"
#include "lucerna/scene.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// A relative l2 error with the noise taken out.
struct BoxErrorEstimate {
  /// |s f - t| / |t|, weighted by solid angle (or area).
  double value = 0.0;
  /// What the noise of f alone makes of it, from the scatter of the replicates.
  double floor = 0.0;
  /// sqrt(max(0, value^2 - floor^2)): what is left.
  double excess = 0.0;
  /// Of the excess; not a number where the noise is not known (fewer than two replicates).
  double standard_error = 0.0;
};

/// The error of a design (docs/theory/design.md): every figure with its error.
struct DesignError {
  /// In 12 x 12, 24 x 24 and 48 x 48 boxes over the target's rectangle. The headline is c48.excess.
  BoxErrorEstimate c12, c24, c48;
  /// What the flux shares were multiplied with to stand beside the target at n = 48 (1 in absolute mode).
  double scale = 1.0;
  /// Share of the sources' flux in the rectangle.
  Estimate in_rectangle;
  /// Share of the sources' flux that leaves the luminaire but not into the rectangle, and the part of that
  /// which met no mirror: no shape of the mirror can send it elsewhere, only stand in its way.
  Estimate outside_share, outside_direct;
  /// l2 over the cells outside, relative to the target's l2 in the rectangle, at the scale above.
  BoxErrorEstimate outside;
  /// Largest deviation of one of the 48 x 48 boxes as a share of the target's brightest box, with the
  /// standard error of that box. Noise raises it: the largest of 2304 deviations.
  Estimate worst_cell;
  /// Rays that it was evaluated by.
  std::uint64_t rays = 0;
};

/// What no mirror of an aperture and a height can do better than, whatever its shape.
struct DesignBound {
  /// Below this no error in 48 x 48 boxes can be: with as much light in the rectangle as was reached by
  /// shape, with any in absolute mode. 0 where nothing forbids the target. The larger of the two that
  /// follow: étendue and luminance of the light, and the light that passes the mirror's rim unreflected.
  double error = 0.0;
  double etendue_error = 0.0, direct_error = 0.0;
  /// Where it binds: the share of the target's light in its brightest boxes, the largest share of the
  /// sources' flux that their étendue can take, and that étendue in mm^2 sr.
  double target_share = 0.0, max_share = 1.0, etendue_mm2sr = 0.0;
};

/// Whether a bound is kept: decided only where the noise leaves no doubt.
enum class ZoneVerdict { met, missed, undetermined };
/// "met", "missed" or "not determined".
std::string_view to_string(ZoneVerdict verdict);

/// One bound of a zone against the light that was found.
struct ZoneBoundCheck {
  /// The key of [[target.zone]] that sets it.
  std::string key;
  /// A lower bound, else an upper one.
  bool is_min = true;
  /// In cd or lx, or a multiple of the bound's reference, which `reference` is (1 for absolute bounds).
  double allowed = 0.0;
  /// What `allowed` is a multiple of.
  double reference = 1.0;
  /// Of the cell that comes nearest to breaking it, in the same unit as `allowed`.
  Estimate found;
  /// Where that cell is, in words.
  std::string place;
  /// What that cell is short of the bound (or above it), over the bound; negative: so much is to spare.
  double missing = 0.0;
  /// Whether the bound is kept.
  ZoneVerdict verdict = ZoneVerdict::met;
  /// Of upper bounds in cd or lx: the most light of any cell that met neither mirror nor body.
  std::optional<Estimate> direct;
  /// True where that light alone breaks the bound: no mirror with this rim keeps it.
  bool broken_by_direct = false;
};

/// A zone's light, by its measuring cells, in cd or lx.
struct ZoneCheck {
  /// As the project has it.
  std::string name;
  /// Number of measuring cells.
  std::size_t cells = 0;
  /// Side of the cells, degrees or mm.
  double cell = 1.0;
  /// True for lx on a plane, false for cd by direction.
  bool on_plane = false;
  /// Darkest and brightest cell, with their own errors; noise spreads the two. And the mean over the zone.
  Estimate min, max, mean;
  /// Each bound that is set.
  std::vector<ZoneBoundCheck> bounds;

  /// Missed where any bound is, else undetermined where any is.
  [[nodiscard]] ZoneVerdict verdict() const;
};

/// One limit and what was found.
struct LimitCheck {
  /// The key of [design.limits], or which keep-out zone or body.
  std::string limit;
  /// In the unit of the limit.
  double allowed = 0.0;
  /// In the same unit: of light with its standard error, of the form exactly.
  Estimate found;
  /// True if what was found is allowed.
  bool held = true;
};

/// How far a made luminaire may be from the designed one: [design.tolerances]. The defaults are what a placed
/// LED and a moulded, metallised mirror are commonly held to.
struct ToleranceRanges {
  /// The sources together, along each of x, y and z, either way.
  double source_shift_mm = 0.1;
  /// The sources together about x and y through their middle, either way.
  double source_tilt_deg = 1.0;
  /// Gaussian slope error of the mirror (standard deviation about each axis), added to its own as squares.
  double slope_error_mrad = 1.0;
  /// Change of the reflectance, either way.
  double reflectance = 0.02;
  /// Combined cases: everything at once, each drawn evenly from its range.
  int samples = 16;
  /// Rays of each case: the same ones for all, so that differences are not noise.
  std::uint64_t rays = std::uint64_t{1} << 18;
};

/// What is changed in one case.
struct ToleranceCase {
  /// The case in words.
  std::string name;
  /// Of the sources together.
  Vec3 shift_mm;
  /// Tilts of the sources, slope error of the mirror, change of its reflectance.
  double tilt_x_deg = 0.0, tilt_y_deg = 0.0, slope_error_mrad = 0.0, reflectance = 0.0;
};

/// What is watched: of the whole luminaire, all light in the far field.
struct ToleranceMetrics {
  /// Of the sources' flux, that leaves.
  Estimate efficiency;
  /// Largest intensity (cd or W/sr), and on the axis.
  Estimate peak, centre;
  /// Full angles at half the maximum in C0-C180 and C90-C270; nothing where they are not determined.
  std::optional<Estimate> beam_c0_deg, beam_c90_deg;
};

/// How one figure varies over the combined cases. Errors are those of the rays; the same rays serve all
/// cases, so that differences between cases are better known than either. A case whose figure is not
/// determined is left out.
struct ToleranceSpread {
  /// Which of ToleranceMetrics.
  std::string figure;
  /// Of the design itself, and the mean over the cases.
  Estimate nominal, mean;
  /// Over the cases, not a number where fewer than two count; its error is that of drawing so few of them.
  Estimate standard_deviation;
  /// The extreme cases.
  Estimate min, max;
  /// Combined cases whose figure is determined.
  int cases = 0;
};

/// Result of a tolerance sweep: the cases and their scatter.
struct ToleranceSweep {
  /// What was varied.
  ToleranceRanges ranges;
  std::vector<ToleranceCase> cases;       ///< the first is the design itself, then one change a case
  std::vector<ToleranceMetrics> figures;  ///< of each case
  std::vector<ToleranceSpread> spread;    ///< over the combined cases, figure by figure
};

/// A change of the mirror that was tried, and what a design with it came to.
struct AdviceTrial {
  /// The change in words.
  std::string change;
  /// Validated like a result.
  DesignError error;
  /// Whether the error is less than the result's by more than three standard errors of the difference, with
  /// no less light in the target's rectangle (but for half a per cent of the source's) and all limits held.
  bool helps = false;
};

/// Why a design ended.
enum class DesignTermination { converged, time, interrupted };

/// "converged", "time" or "interrupted".
std::string_view to_string(DesignTermination end);

/// A mirror of the trade between error and light.
struct ParetoPoint {
  /// `light_weight` of [design] that it was fitted with, and how far its vertex is from the given mirror's.
  double light_weight = 0.0, vertex_mm = 0.0;
  /// Validated with fewer rays than a result; `in_rectangle` is the light.
  DesignError error;
};

/// A step of a design that is running; a line of its history.
struct DesignStep {
  /// Evaluations so far, and the rays of all of them.
  int evaluations = 0;
  std::uint64_t rays = 0;
  /// Of the best so far, in the bins of the present stage, and what the noise alone makes of it.
  double relative_rms = 0.0, floor = 0.0;
  /// Shares of the sources' flux that leave the luminaire, and that fall into the target's rectangle (0 where
  /// the search does not look).
  double efficiency = 0.0, in_rectangle = 0.0;
  /// Whether this step became the best so far.
  bool accepted = true;
};

/// Called after every step, on the thread that designs, with the state to resume from.
using DesignWatcher = std::function<void(const DesignStep& step, const std::string& checkpoint)>;

/// How a project is designed.
struct DesignSettings {
  /// Of all random numbers; the same seed gives the same design.
  std::uint64_t seed = 1;
  /// Seconds after which to have stopped with the best so far, validated and traced; absent: `time_s` of
  /// [design]. Time only stops: every decision depends on counts.
  std::optional<double> time_s;
  /// Rays of an evaluation at the end, at most, and at least 8192; up to four times as many validate.
  std::uint64_t max_rays = std::uint64_t{1} << 23;
  /// Where evaluations are traced. `cuda` throws InputError where there is no device.
  TraceDevice device = TraceDevice::automatic;
  /// Also a tolerance sweep, with default ranges where the project has no [design.tolerances].
  bool tolerances = false;
  /// Also the trade between error and light, and what other outlines and families would bring, each designed
  /// for the same time; both after `time_s`.
  bool pareto = false, advise = false;
  /// A state to go on from: DesignedMirror::checkpoint, or what a DesignWatcher got, of the same problem,
  /// seed and rays; the result is then that of a design which never stopped, to the bit. Empty: from the
  /// start.
  std::string checkpoint;
};

/// What was found of a design's mirror.
struct DesignFindings {
  /// Why it ended.
  DesignTermination end = DesignTermination::converged;
  /// Against the target, by fresh rays through the exported mesh; and of what the search
  /// began with: the given mirror, or where limits exclude it one within them.
  DesignError error, start_error;
  /// The target's zones in the light of the result and of the start, by the same rays.
  std::vector<ZoneCheck> zones, start_zones;
  /// What no mirror of this aperture and height can be better than, with the light that this one has in the
  /// target's rectangle.
  DesignBound bound;
  /// Every limit that was set, as found in the exported mesh and its light.
  std::vector<LimitCheck> limits;
  /// Shares of the sources' flux: what leaves the luminaire; what the mirror's face, its back and bodies
  /// absorb; rays that were given up.
  Estimate efficiency, absorbed, back, bodies, lost;
  /// What was asked for by `pareto`.
  std::vector<ParetoPoint> pareto;
  /// What was tried for `advise`.
  std::vector<AdviceTrial> advice;
  /// What is known of why the error is not smaller, in one sentence each, with the figure that shows it.
  std::vector<std::string> remarks;
  /// Evaluations of the objective.
  int evaluations = 0;
  /// Rays of all of them.
  std::uint64_t rays = 0;
};

/// What a design's files are made of; opaque to users of the library.
struct DesignRecord;
/// The same of a lens.
struct LensRecord;

/// What a design came to: a mirror, or a lens.
struct DesignedMirror : DesignFindings {
  /// In its own frame: what cad.h writes. Without a surface where a lens was designed.
  Reflector reflector;
  /// Where it, or the lens, is in the luminaire frame.
  Frame world_from_reflector;
  /// The project with this mirror, as a file that `trace` takes.
  std::string project_text;
  /// The light of the finished project: raw sums and figures.
  TraceResult traced;
  /// All figures of `traced`.
  TraceMetrics light;
  /// If DesignSettings::tolerances asked for it.
  std::optional<ToleranceSweep> tolerances;
  /// Every step, in order; those of this call.
  std::vector<DesignStep> history;
  /// The state to resume from.
  std::string checkpoint;
  /// For `write_design`; null for a lens.
  std::shared_ptr<const DesignRecord> record;
  /// The lens that was shaped, if the project asked for one.
  std::optional<Solid> lens;
  /// For `write_design`; null for a mirror.
  std::shared_ptr<const LensRecord> lens_record;
};

/// Shapes a project's mirror until its light is the project's [target], as well as it can be: a free form, a
/// profile of revolution or of a trough, within [design.limits] (docs/theory/design.md and
/// free-form-search.md). With `free_sides` in [design] it shapes faces of the project's solid of revolution
/// instead: lenses have neither checkpoints, `pareto`, `advise` nor tolerances, and are refused with them;
/// `bodies` is then what the medium absorbs. The result is validated by code that shares nothing with the
/// fit, never worse than the given mirror by that, and traced. When progress asks to stop, the result is the
/// best so far, whole, with `end` saying so. Progress phases "rays", "design", "validate", "trace",
/// "tolerances". Uses all threads; other calls may run at the same time. Throws InputError with file, line,
/// key, found and expected on a project that cannot be designed.
[[nodiscard]] DesignedMirror design(const std::filesystem::path& project, const DesignSettings& settings = {},
                                    Progress& progress = no_progress());

/// The same of a project that has been read; `name` is what messages call it.
[[nodiscard]] DesignedMirror design(Project project, const std::string& name,
                                    const DesignSettings& settings = {}, Progress& progress = no_progress(),
                                    const DesignWatcher& watcher = {});

}  // namespace lucerna
#pragma GCC visibility pop
