// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lucerna/distributed/ray_intervals.h"
#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/trace.h"

namespace lucerna {

/// The sums of some rays of a run: those of `done`, which need not be neighbours. `sums.first_ray` and
/// `last_ray` are those of the whole run.
struct PartialTrace {
  TraceResult sums;
  RayIntervals done;

  /// Adds the rays of a range (TraceResult::first_ray, last_ray). Throws InputError unless both are of one
  /// scene and tracer (`check_addable`).
  void add(const TraceResult& range);
  /// Adds rays that it does not have yet; errors alike.
  void add(const PartialTrace& other);
};

/// A partial trace as the bytes of a file, with a checksum: what one rank has so far.
std::string encode_part(const PartialTrace& part, const TraceOrigin& origin);

struct StoredPart {
  PartialTrace part;
  TraceOrigin origin;
};

/// The inverse, but `sums.first_ray` and `last_ray` are 0 and the number of rays. Throws InputError with the
/// name on anything that `encode_part` cannot have made, a torn file for one.
StoredPart decode_part(std::string_view bytes, const std::string& name);

/// Errors as `decode_part`, and if the file cannot be read.
StoredPart read_part_file(const std::filesystem::path& path);

}  // namespace lucerna
