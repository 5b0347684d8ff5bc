// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/progress.h"
#include "lucerna/ray_file.h"

namespace lucerna {

/// What is to change on the way from one ray file to another.
struct RayConversion {
  /// Rays to keep of the file's; absent = all. Weights grow so that their sum stays.
  std::optional<std::uint64_t> rays;
  std::uint64_t seed = 1;
  /// Replaces the stated total flux, in the rays' unit; > 0.
  std::optional<double> flux;
  /// Refuses a file that the reader warns about.
  bool strict = false;
  /// Unit of lengths in the new file, as WriteOptions names them.
  std::string length_unit = "mm";
  /// Turns and moves all rays.
  Frame new_from_old;
};

/// What was done: rays and flux that were written, and all that was odd or lost.
struct RayConversionResult {
  std::uint64_t rays = 0;
  std::optional<double> flux;
  FluxUnit flux_unit = FluxUnit::lumen;
  std::vector<std::string> warnings;
};

/// Applies a rigid motion to every ray of a block. Directions stay unit to float rounding.
void transform(RayBlock& block, const Frame& new_from_old);

/// Streams `in` to `out` (a format's name as `--to` takes it) in blocks: memory does not grow with the file.
/// Choosing rays reads the file twice. Throws InputError as readers and writers do, when more rays are asked
/// for than there are, and Interrupted; then no file appears.
RayConversionResult convert_ray_file(const std::filesystem::path& in, const std::filesystem::path& out,
                                     const std::string& format, const RayConversion& conversion,
                                     const ReadOptions& read_options = {},
                                     Progress& progress = no_progress());

}  // namespace lucerna
