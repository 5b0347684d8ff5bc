// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/rays.h"
#include "lucerna/source_model.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How far a model of one half of some rays is from the other half, which it has not seen.
struct HeldOutComparison {
  /// Rays that the model was made from, and rays that it was compared with.
  std::uint64_t training_rays = 0, held_out_rays = 0;
  /// The five views; `raw` is the noise of the training half.
  RaySetComparison views;
  /// Illuminance on the focus plane, the smallest cells first.
  std::array<ScaleDifference, 5> scales;
};

/// Deals `rays` out by chance to two halves, makes a model of one by `options`, and compares it with the
/// other. A model of all the rays has twice as many to learn from. Absent where a half has fewer than 100
/// rays or no flux. The same rays and options give the same for any number of threads. Throws as `compress`.
/// Cost: that of `compress` for half of the rays, 1 us a ray and thread for the views, and 0.5 s.
[[nodiscard]] std::optional<HeldOutComparison> compare_held_out(const RaySet& rays,
                                                                const CompressOptions& options = {},
                                                                Progress& progress = no_progress());

/// The same for ray files, which are superposed as `compress` does; of more than `max_rays` rays so many,
/// spread over the files. Memory: that of `max_rays` rays. Throws what `open_ray_file` throws too; UsageError
/// without files.
[[nodiscard]] std::optional<HeldOutComparison> compare_held_out(
    const std::vector<std::filesystem::path>& files, std::uint64_t max_rays,
    const CompressOptions& options = {}, Progress& progress = no_progress());

}  // namespace lucerna
#pragma GCC visibility pop
