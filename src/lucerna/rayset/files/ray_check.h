// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/ray_file.h"

namespace lucerna {

/// `warning`: readable, but a strict reader might refuse or the file may mean something else. `error`: cannot
/// be used as it is.
enum class Severity { warning, error };

/// "warning" or "error".
std::string_view to_string(Severity severity);

struct Finding {
  Severity severity = Severity::error;
  /// "byte 20", "ray 17 (byte 37468)", "line 3"; empty for the file as a whole.
  std::string place;
  std::string message;
};

/// Every fault of a ray file, in the order of the file: the reader's error, or else its warnings, faulty rays
/// (the first and how many), zero rays, a flux that is not stated, weights of which the sum differs from the
/// stated flux by more than 0.1 %, no flux at all. Empty = nothing to complain about. Reads the whole file;
/// never throws for what is wrong with it.
std::vector<Finding> check_ray_file(const std::filesystem::path& path, const ReadOptions& options = {},
                                    Progress& progress = no_progress());

}  // namespace lucerna
