// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/photometry/binning/binned_intensity.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {

/// Intensities at the angles of a far field's grid, with their errors (binned_intensity.h).
BinnedIntensity node_intensity(const CountedFarField& field);

/// The largest standard error of a value above 1 % of the largest value, over the largest value: what
/// `trace --noise` brings down. NaN where errors are not known, 0 for a dark far field.
double node_noise(const BinnedIntensity& intensity);

/// The largest of those of all far fields; NaN if there are none.
double node_noise(const TraceResult& result);

/// The largest relative noise of the far fields' peaks (peak_estimate.h); NaN where none is known.
double peak_noise(const TraceResult& result);

}  // namespace lucerna
