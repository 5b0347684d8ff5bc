// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lucerna/photometry/binning/counted_sphere.h"
#include "lucerna/trace.h"

namespace lucerna {

/// A far field with its flux by replicate.
struct CountedFarField : FarField {
  /// The same flux, and what it is without each replicate that has rays.
  JackknifedFlux replicated;
};

/// The far field that detector `index` of TraceResult::far_fields saw.
CountedFarField far_field(const TraceResult& result, std::size_t index);

/// The same in the cells that were counted, `counted_parts` to a cell of the grid. Throws what CountedSphere
/// throws. About 130 bytes a cell.
CountedSphere counted_far_field(const TraceResult& result, std::size_t index);

/// Flux that left, direct and reflected, and without each replicate.
Jackknife out_flux(const TraceResult& result);

}  // namespace lucerna
