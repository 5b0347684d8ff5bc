// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lucerna/photometry/beam.h"
#include "lucerna/photometry/binned_intensity.h"
#include "lucerna/trace/trace_result.h"

namespace lucerna {

/// What is quoted of one far field.
struct FarFieldFigures {
  FarField field;
  BinnedIntensity intensity;
  BeamFigures beam;
  /// Standard error of beam.centre_cd; NaN where it is not known.
  double centre_standard_error_cd = 0.0;
  /// Flux that left, all directions.
  Estimate flux;
  /// Relative noise of the whole distribution: root of the solid-angle-weighted sum of squared standard
  /// errors over that of the squared intensities. NaN where it is not known.
  double noise = 0.0;
};

/// All figures of a trace, worked out once for text, JSON and files.
struct TraceFigures {
  Ledger ledger;
  std::vector<FarFieldFigures> far_fields;
};

/// Cost: a few passes over the bins.
TraceFigures trace_figures(const TraceResult& result);

/// Beam and field angles by both definitions, one object a pair of planes: what JSON results call the planes.
nlohmann::ordered_json beam_planes_json(const BeamFigures& beam);

/// `ledger` and `detectors` of design.md section 3. What is not known is null.
nlohmann::ordered_json trace_json(const TraceFigures& figures);

/// A short table for people, one line an entry.
std::vector<std::string> trace_summary(const TraceFigures& figures);

}  // namespace lucerna
