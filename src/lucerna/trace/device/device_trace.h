// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/scene.h"
#include "lucerna/trace.h"
#include "lucerna/trace/device/accelerator.h"
#include "lucerna/trace/engines/ray_numbering.h"

namespace lucerna {

using Accelerators = std::vector<std::unique_ptr<Accelerator>>;

/// `trace` on accelerators (at least one), each with an equal range of the rays' numbers: rays are drawn from
/// models, followed and counted there; those of ray files and analytic emitters are drawn on the CPU while
/// the chunk before is traced. The sums are whole numbers, so they do not depend on how many accelerators
/// there are. Errors as `trace`. Memory of
/// each accelerator: DeviceScene's, and 3 launches of its chunk_blocks(), of 28 bytes a ray if the CPU draws
/// them and 28 if they are kept.
TraceResult trace_on(const Accelerators& accelerators, const Scene& scene, const TraceOptions& options,
                     Progress& progress = no_progress());

/// The part of `trace_on` that follows rays: those that `result` names are added to it.
void run_on(const Accelerators& accelerators, const Scene& scene, const RayNumbering& numbering,
            const TraceOptions& options, TraceResult& result, Progress& progress);

}  // namespace lucerna
