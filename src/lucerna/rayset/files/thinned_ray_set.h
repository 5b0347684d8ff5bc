// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/progress.h"
#include "lucerna/rays.h"

namespace lucerna {

struct ThinOptions {
  /// About so many rays are kept; all where the files have no more.
  std::uint64_t max_rays = ~std::uint64_t{0};
  std::uint64_t seed = 1;
  /// Of the extra columns only wavelengths are kept. Where files differ in colour, or the rays of one have
  /// spectra of their own, each ray is given a wavelength (RayWavelengths); with a file whose colour is not
  /// known all colours are dropped, and a warning says so.
  bool only_wavelengths = false;
  /// Processes that read a part each, and all return the whole: then the call is collective. Null without.
  Peers* peers = nullptr;
};

/// Some of the rays of files.
struct ThinnedRaySet {
  RaySet set;
  /// How many rays the files have.
  std::uint64_t of = 0;
  /// What was odd in the files but could be read, each behind its file's name.
  std::vector<std::string> warnings;
};

/// Some or all rays of files that are superposed: of each file its share, one ray at least, spread over it
/// (RaySubset). Several files keep their fluxes (merge_ray_sets, which says what it refuses). Reads block by
/// block, so that files may be larger than memory. The same rays for any number of peers. Progress phase
/// "read rays". Throws what `open_ray_file` throws, with peers on all of them.
ThinnedRaySet thinned_ray_set(const std::vector<std::filesystem::path>& files, const ThinOptions& options,
                              Progress& progress);

/// All rays of the same files in blocks of a million, one after the other: with the wavelengths that
/// thinned_ray_set gives them (only_wavelengths), and weights whose sum is each file's flux where there are
/// several. What they had to warn of is in the thinned set. Holds one block at a time; several files are read
/// twice. Progress phase "count rays".
void for_each_ray_block(const std::vector<std::filesystem::path>& files,
                        const std::function<void(const RayBlock&)>& use, Progress& progress);

}  // namespace lucerna
