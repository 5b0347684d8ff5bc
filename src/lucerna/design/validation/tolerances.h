// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/design.h"
#include "lucerna/progress.h"
#include "lucerna/project/schema/toml_reader.h"
#include "lucerna/scene.h"

namespace lucerna {

/// Reads [design.tolerances]: the fields above by name. Throws InputError with file, line, key.
ToleranceRanges read_tolerances(TomlReader reader);

/// The cases: "nominal", "shift_x+", ..., "reflectance-", then "combined_1" and so on, drawn from `seed`.
std::vector<ToleranceCase> tolerance_cases(const ToleranceRanges& ranges, std::uint64_t seed);

/// The scene of a case. Sources move as one body about the flux-weighted mean of their origins; a reflectance
/// stays within [0, 1].
Scene changed(const Scene& scene, const ToleranceCase& change);

/// Traces every case that changes anything, one to two seconds each. Progress phase "tolerances", in cases.
/// Throws Interrupted when asked to stop. `peers`: processes that make the same sweep and share its cases
/// (peers.h); null: this one alone.
ToleranceSweep tolerance_sweep(const Scene& scene, const ToleranceRanges& ranges, std::uint64_t seed,
                               Progress& progress = no_progress(), Peers* peers = nullptr);

/// One line a case: its changes, its figures.
std::string tolerances_csv(const ToleranceSweep& sweep);

}  // namespace lucerna
