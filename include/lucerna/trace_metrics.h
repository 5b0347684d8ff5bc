// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/far_field_metrics.h"
#include "lucerna/progress.h"
#include "lucerna/trace.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// What is quoted of one far field.
struct FarFieldResult {
  /// Flux by cell.
  FarField field;
  /// Intensity on a CIE Type C grid.
  BinnedIntensity intensity;
  /// Peak, beam angles, zones, estimated from the counted cells and not from the grid's angles.
  FarFieldMetrics metrics;
  /// Relative noise of the whole distribution: root of the solid-angle-weighted sum of squared standard
  /// errors over that of the squared intensities. NaN where it is not known.
  double noise = 0.0;
  /// The largest standard error of a value above 1 % of the peak, over the peak. NaN where it is
  /// not known.
  double node_noise = 0.0;
};

/// What is quoted of a plane (illuminance) or luminance image.
struct PlaneMetrics {
  /// The figure of each cell.
  PlaneImage image;
  /// What makes it a luminance image; absent for a plane.
  std::optional<LuminanceDetector> view;
  /// Mean, least and greatest, corrected for noise.
  PlaneExtremes extremes;
  /// The middle of the brightest cell in the grid's frame.
  double peak_x_mm = 0.0, peak_y_mm = 0.0;
  /// Relative noise of the whole image: root of the sum of squared standard errors over that of the squared
  /// values; NaN where it is not known.
  double noise = 0.0;
};

/// Rays that left, to be written as a file.
struct RayOutputMetrics {
  /// The detector that keeps them.
  RayDetector detector;
  /// How many there are.
  std::uint64_t rays = 0;
  /// What they carry.
  Estimate flux;
};

/// All figures of a trace, worked out once for text, JSON and files.
struct TraceMetrics {
  /// Where the light went.
  Ledger ledger;
  /// One for each far-field detector.
  std::vector<FarFieldResult> far_fields;
  /// One for each plane, and for each luminance detector.
  std::vector<PlaneMetrics> planes, luminances;
  /// One for each ray detector.
  std::vector<RayOutputMetrics> rays;
};

/// For which figures light is followed backward, where it can be.
struct BackwardLight {
  /// Peaks and axes of far fields: some seconds each.
  bool far_fields = true;
  /// Planes and luminance images.
  bool images = true;
};

/// The figures of a trace. Thread safe. Cost: a few passes over the bins.
[[nodiscard]] TraceMetrics trace_metrics(const TraceResult& result);
/// The same with the scene that was traced, where all sources know their luminance (models, simple emitters),
/// light can be followed backward through the scene and a ray is reflected three times or less on average:
/// the far fields' peaks and axes are then exact, without bins and kernels, and planes and luminance images
/// that few rays find are averaged with backward light. Some seconds a far field; as many backward rays for a
/// plane or image as a sixteenth of those traced, 2^18 to 2^21, about 1 us each on a simple scene. What
/// `backward` leaves out is as without the scene. Once `progress` asks to stop, before or meanwhile, all
/// figures are those of the counted rays, as above.
[[nodiscard]] TraceMetrics trace_metrics(const TraceResult& result, const Scene& scene,
                                         BackwardLight backward = {},
                                         const Progress& progress = no_progress());

/// "C 12.3 +- 0.4, gamma 30.2 +- 0.1 deg", or what is known of it: "on the axis within 0.3 deg", "gamma 30.2
/// +- 0.1 deg, C not determined", "not determined".
std::string peak_place_text(const PeakEstimate& peak);
/// "62.87 +- 0.03 deg" or "not determined".
std::string angle_text(const std::optional<Estimate>& angle);

/// "lx", "cd/m2", "W/m2" or "W/(m2 sr)".
std::string plane_unit(const PlaneMetrics& figures);

/// The name of a ray detector's file: its own with the ending of its format.
std::string ray_file_name(const RayDetector& detector);

/// A short table for people, one line an entry.
std::vector<std::string> trace_summary(const TraceMetrics& figures);

}  // namespace lucerna
#pragma GCC visibility pop
