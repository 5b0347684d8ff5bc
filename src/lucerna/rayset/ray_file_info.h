// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/progress.h"
#include "lucerna/rayset/ray_statistics.h"
#include "lucerna/rayset/ray_stream.h"
#include "lucerna/rayset/surface_guess.h"

namespace lucerna {

/// All that `lucerna info` says of a ray file.
struct RayFileInfo {
  std::string format, length_unit;
  RaySetHeader header;
  RaySummary summary;
  /// Sum of the weights over the stated flux; absent if none is stated. 1 in files whose rays carry the
  /// total.
  std::optional<double> flux_ratio;
  /// Étendue in mm^2 sr of the brightest 50, 90 and 99 % of the flux.
  double etendue_p50 = 0.0, etendue_p90 = 0.0, etendue_p99 = 0.0;
  SurfaceGuess surface;
  /// "none", "555 nm for all rays", "380 to 780 nm, one per ray", "450 to 620 nm, table of 86 points", ...
  std::string spectrum;
  std::vector<std::string> warnings;
};

/// Reads a file once, in blocks, and describes it. Étendue and surface come from at most 2^20 rays spread
/// evenly over the file, so that memory stays below 100 MB beside extra columns. Throws as the readers do.
RayFileInfo describe_ray_file(const std::filesystem::path& path, const ReadOptions& options = {},
                              Progress& progress = no_progress());

}  // namespace lucerna
