// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lucerna/diagnostic.h"
#include "lucerna/progress.h"
#include "lucerna/ray_file.h"

namespace lucerna {

/// Every fault of a ray file, in the order of the file: the reader's error, or else its warnings, faulty rays
/// (the first and how many), zero rays, a flux that is not stated, weights of which the sum differs from the
/// stated flux by more than 0.1 %, no flux at all. Empty = nothing to complain about. Reads the whole file;
/// never throws for what is wrong with it.
std::vector<Diagnostic> check_ray_file(const std::filesystem::path& path, const ReadOptions& options = {},
                                       Progress& progress = no_progress());

}  // namespace lucerna
