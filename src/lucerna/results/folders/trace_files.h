// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {

/// Writes what `trace` leaves in a folder: `result.json`, `project.toml`, and for each
/// detector NAME: far field `NAME.ldt NAME.ies NAME.csv NAME.svg`, plane and luminance `NAME.csv NAME.png`,
/// rays `ray_file_name`, which is NAME.tm25ray unless the project says another format. A radiometric far
/// field has no .ldt: the format has no unit for it. Each file appears whole or not at all; returns their
/// names. `rays` are TraceResult::out_rays, `result` is what goes into result.json. What a ray format had to
/// leave out goes to `warnings`.
std::vector<std::string> write_trace_files(const std::filesystem::path& folder, const TraceOrigin& origin,
                                           const TraceMetrics& figures, const RayBlock& rays,
                                           const nlohmann::ordered_json& result,
                                           std::vector<std::string>* warnings = nullptr);

/// The table NAME.csv: a header line, then c_deg, gamma_deg, intensity and its standard error per grid angle.
std::string far_field_csv(const FarFieldResult& figures);

/// The table NAME.csv of a plane or luminance image: a header line, then per cell x_mm, y_mm (its middle in
/// the grid's frame), the value and its standard error (empty where it is not known); x runs first, both from
/// the negative side. The value's column: illuminance_lx, luminance_cd_per_m2, irradiance_w_per_m2 or
/// radiance_w_per_m2_sr.
std::string plane_csv(const PlaneMetrics& figures);

/// The picture NAME.png as rows of RGB from the top: viridis from 0 to the largest value, y up, x to the
/// right, every cell a square of as many pixels as bring the longer side to 512 or more (at most 64 a cell).
struct PlanePicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
PlanePicture plane_picture(const PlaneImage& image);

}  // namespace lucerna
