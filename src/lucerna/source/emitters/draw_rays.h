// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"

namespace lucerna {

/// Writes rays 0 .. n - 1 of `source` to `writer` (made for a header without extra columns, or with one of
/// wavelengths if the source has them) and finishes it;
/// weights are multiplied by flux() / n, so that files whose rays carry lm or W hold what they should.
/// Returns the writer's warnings. Rays are drawn on all threads, the file is the same for any number of them.
/// Throws Interrupted when asked to stop, and then leaves no file.
std::vector<std::string> draw_rays(const RaySource& source, const Sequence& sequence, std::uint64_t n,
                                   RayWriter& writer, Progress& progress = no_progress());

/// The same into memory, with the source's own weights (mean 1).
RayBlock draw_rays(const RaySource& source, const Sequence& sequence, std::size_t n);

}  // namespace lucerna
