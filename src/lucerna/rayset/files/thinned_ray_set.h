// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/rays.h"

namespace lucerna {

/// Some of the rays of files.
struct ThinnedRaySet {
  RaySet set;
  /// How many rays the files have.
  std::uint64_t of = 0;
};

/// About `max_rays` rays of files that are superposed, all where they have no more: of each file its share,
/// one ray at least, spread over it (RaySubset). Several files keep their fluxes (merge_ray_sets, which says
/// what it refuses). Reads block by block, so that files may be larger than memory. Progress phase "read
/// rays". Throws what `open_ray_file` throws.
ThinnedRaySet thinned_ray_set(const std::vector<std::filesystem::path>& files, std::uint64_t max_rays,
                              std::uint64_t seed, Progress& progress);

}  // namespace lucerna
