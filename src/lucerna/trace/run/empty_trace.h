// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/trace.h"

namespace lucerna {

/// What `trace` would return had it followed no ray yet: detectors and causes with sums of zero, `isa` as
/// asked for. Errors as `trace`.
TraceResult empty_trace(const Scene& scene, const TraceOptions& options);

}  // namespace lucerna
