// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/photometry/beam.h"
#include "lucerna/photometry/binned_intensity.h"
#include "lucerna/photometry/far_field_metrics.h"
#include "lucerna/report/svg_axes.h"
#include "lucerna/trace/plane_extremes.h"
#include "lucerna/trace/trace_result.h"

namespace lucerna {

/// What is quoted of one far field.
struct FarFieldFigures {
  FarField field;
  BinnedIntensity intensity;
  /// Peak, beam angles, zones, estimated from the counted cells and not from the grid's angles.
  FarFieldMetrics metrics;
  /// Relative noise of the whole distribution: root of the solid-angle-weighted sum of squared standard
  /// errors over that of the squared intensities. NaN where it is not known.
  double noise = 0.0;
  /// The largest standard error of a value above 1 % of the peak, over the peak (node_noise.h). NaN where it
  /// is not known.
  double node_noise = 0.0;
};

/// What is quoted of a plane (illuminance) or luminance image.
struct PlaneFigures {
  PlaneImage image;
  /// What makes it a luminance image; absent for a plane.
  std::optional<LuminanceDetector> view;
  PlaneExtremes extremes;
  /// The middle of the brightest cell in the grid's frame.
  double peak_x_mm = 0.0, peak_y_mm = 0.0;
  /// Relative noise of the whole image: root of the sum of squared standard errors over that of the squared
  /// values; NaN where it is not known.
  double noise = 0.0;
};

/// Rays that left, to be written as a file.
struct RayFigures {
  RayDetector detector;
  std::uint64_t rays = 0;
  Estimate flux;
};

/// All figures of a trace, worked out once for text, JSON and files.
struct TraceFigures {
  Ledger ledger;
  std::vector<FarFieldFigures> far_fields;
  std::vector<PlaneFigures> planes, luminances;
  std::vector<RayFigures> rays;
};

/// Cost: a few passes over the bins.
TraceFigures trace_figures(const TraceResult& result);

/// As estimate_json of error_json.h; null as a whole for a figure that is not determined.
nlohmann::ordered_json estimate_json(const std::optional<Estimate>& estimate);

/// Peak, centre and planes of a far field's metrics: what JSON results call `peak`, `centre`, `planes`.
nlohmann::ordered_json beam_json(const FarFieldMetrics& metrics);
/// The same of a distribution that is known exactly, without errors.
nlohmann::ordered_json beam_json(const BeamFigures& beam);

/// "C 12.3 +- 0.4, gamma 30.2 +- 0.1 deg", or what is known of it: "on the axis within 0.3 deg", "gamma 30.2
/// +- 0.1 deg, C not determined", "not determined".
std::string peak_place_text(const PeakEstimate& peak);
/// "62.87 +- 0.03 deg" or "not determined".
std::string angle_text(const std::optional<Estimate>& angle);

/// "lx", "cd/m2", "W/m2" or "W/(m2 sr)".
std::string plane_unit(const PlaneFigures& figures);

/// The name of a ray detector's file: its own with the ending of its format.
std::string ray_file_name(const RayDetector& detector);

/// `ledger` and `detectors` of design.md section 3. What is not known is null.
nlohmann::ordered_json trace_json(const TraceFigures& figures);

/// What diagrams write of a far field: of its entry in `detectors`.
DrawnFigures drawn_figures(const nlohmann::ordered_json& far_field);
DrawnFigures drawn_figures(const FarFieldFigures& far_field);

/// A short table for people, one line an entry.
std::vector<std::string> trace_summary(const TraceFigures& figures);

}  // namespace lucerna
