// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/progress.h"
#include "lucerna/scene.h"
#include "lucerna/trace/toml_reader.h"

namespace lucerna {

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

/// Reads [design.tolerances]: the fields above by name. Throws InputError with file, line, key.
ToleranceRanges read_tolerances(TomlReader reader);

/// What is changed in one case.
struct ToleranceCase {
  std::string name;
  Vec3 shift_mm;
  double tilt_x_deg = 0.0, tilt_y_deg = 0.0, slope_error_mrad = 0.0, reflectance = 0.0;
};

/// What is watched: of the whole luminaire, all light in the far field.
struct ToleranceFigures {
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
  std::string figure;
  Estimate nominal, mean;
  double standard_deviation = 0.0;
  Estimate least, greatest;
};

struct ToleranceSweep {
  ToleranceRanges ranges;
  std::vector<ToleranceCase> cases;       ///< the first is the design itself, then one change a case
  std::vector<ToleranceFigures> figures;  ///< of each case
  std::vector<ToleranceSpread> spread;    ///< over the combined cases, figure by figure
};

/// The cases: "nominal", "shift_x+", ..., "reflectance-", then "combined_1" and so on, drawn from `seed`.
std::vector<ToleranceCase> tolerance_cases(const ToleranceRanges& ranges, std::uint64_t seed);

/// The scene of a case. Sources move as one body about the flux-weighted mean of their origins; a reflectance
/// stays within [0, 1].
Scene changed(const Scene& scene, const ToleranceCase& change);

/// Traces every case. Progress phase "tolerances", in cases. Throws Interrupted when asked to stop.
ToleranceSweep tolerance_sweep(const Scene& scene, const ToleranceRanges& ranges, std::uint64_t seed,
                               Progress& progress = no_progress());

/// One line a case: its changes, its figures.
std::string tolerances_csv(const ToleranceSweep& sweep);

}  // namespace lucerna
