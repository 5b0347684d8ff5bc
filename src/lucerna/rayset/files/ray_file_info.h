// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/statistics/surface_guess.h"

namespace lucerna {

/// All that `lucerna info` says of a ray file.
struct RayFileInfo {
  std::string format, length_unit;
  RaySetHeader header;
  RaySummary summary;
  /// Sum of the weights over the stated flux; absent if none is stated. 1 in files whose rays carry the
  /// total.
  std::optional<double> flux_ratio;
  /// At most 2^20 rays, spread evenly over the file, without extra columns.
  RayBlock some_rays;
  SurfaceGuess surface;
  /// "none", "555 nm for all rays", "380 to 780 nm, one per ray", "450 to 620 nm, table of 86 points", ...
  std::string spectrum;
  std::vector<std::string> warnings;
};

/// Reads a file once, in blocks, and describes it. The surface comes from `some_rays`; memory stays below
/// 100 MB beside extra columns. Throws as the readers do.
RayFileInfo describe_ray_file(const std::filesystem::path& path, const ReadOptions& options = {},
                              Progress& progress = no_progress());

}  // namespace lucerna
