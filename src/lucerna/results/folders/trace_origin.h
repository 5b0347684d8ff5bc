// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/project.h"

namespace lucerna {

/// Where a trace comes from: what its files and a later `merge` need of the project, without its inputs.
struct TraceOrigin {
  /// Tells two scenes apart: a hash of the project's tables, with every file replaced by the hash of its
  /// bytes, so that the same project on another machine is the same scene. [target] and [design] do not
  /// count.
  std::string scene_id;
  std::string program_version;
  /// `project_text`.
  std::string project;
  /// The light-emitting area that photometric files state: the opening of the first mirror, if it looks up or
  /// down; width 0 = a circle; both 0 = not known.
  double luminous_length_mm = 0.0, luminous_width_mm = 0.0;
  friend bool operator==(const TraceOrigin&, const TraceOrigin&) = default;
};

/// Reads all of the project's files once, for their hashes.
TraceOrigin trace_origin(const Project& project);

}  // namespace lucerna
