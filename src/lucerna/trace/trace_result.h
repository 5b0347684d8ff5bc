// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/estimate.h"
#include "lucerna/core/flux_unit.h"
#include "lucerna/core/sequence.h"
#include "lucerna/photometry/counted_sphere.h"
#include "lucerna/rayset/ray_block.h"
#include "lucerna/trace/far_field.h"
#include "lucerna/trace/plane_detector.h"
#include "lucerna/trace/tally.h"

namespace lucerna {

/// The rays of one source in one block of 512 numbers that left; runs ascend by (block, source), so that the
/// kept rays of two ranges join to the order of one run, also where the cut is within a block.
struct OutRun {
  std::uint64_t block = 0;
  std::uint32_t source = 0, rays = 0;
  friend bool operator==(const OutRun&, const OutRun&) = default;
};

/// What a trace leaves: raw sums by replicate, before any normalisation, so that ranges of rays can be added.
struct TraceResult {
  /// The rays traced, [first_ray, last_ray).
  std::uint64_t first_ray = 0, last_ray = 0;
  std::uint64_t seed = 0;
  SequenceKind sequence = SequenceKind::sobol;
  int max_bounces = 0;
  /// Which tracer and instruction set made the sums: only equal ones can be merged.
  std::string isa;
  /// Flux of all sources together.
  double flux = 0.0;
  FluxUnit unit = FluxUnit::lumen;
  std::vector<FarFieldDetector> far_fields;
  std::vector<PlaneDetector> planes;
  std::vector<LuminanceDetector> luminances;
  std::vector<RayDetector> ray_detectors;
  /// Causes of absorption after the mirrors': bodies, then cover glasses.
  std::vector<std::string> body_names;
  /// kReplicates tallies.
  std::vector<Tally> replicates;
  /// If the scene has ray detectors: where rays left and where to, in the order of `out_runs`. Together they
  /// carry ledger().out_direct + out_reflected; weights are in mean rays.
  RayBlock out_rays;
  std::vector<OutRun> out_runs;
};

/// Where the light went. Every figure in the unit of the sources' flux. A standard error is NaN where it is
/// not known: fewer than two replicates have rays.
struct Ledger {
  FluxUnit unit = FluxUnit::lumen;
  /// Exactly the flux of the sources.
  double emitted = 0.0;
  Estimate out_direct, out_reflected;
  /// By cause: "mirror" (what its face kept), "mirror_back", then the bodies, then the cover glasses.
  std::vector<std::pair<std::string, Estimate>> absorbed;
  /// By cause: "bounce_limit", "not_finite"; rays beside it.
  std::vector<std::pair<std::string, Estimate>> lost;
  /// All causes together.
  Estimate all_lost;
  std::uint64_t lost_rays = 0;
  std::uint64_t rays = 0;
  Estimate reflections_per_ray;
};

/// The figures of the energy ledger. emitted = out + absorbed + lost to rounding of the last digit.
Ledger ledger(const TraceResult& result);

/// Flux by far-field cell, numbered as in FarFieldGrid: c * gamma_count + g.
struct FarField {
  std::string name;
  double c_step_deg = 0.0, gamma_step_deg = 0.0;
  std::size_t c_count = 0, gamma_count = 0;
  bool tent = false;
  FluxUnit unit = FluxUnit::lumen;
  std::vector<double> flux;
  /// NaN where not known, as in Ledger.
  std::vector<double> standard_error;
  /// The same flux, and what it is without each replicate that has rays.
  JackknifedFlux replicated;
};

/// The far field that detector `index` of TraceResult::far_fields saw.
FarField far_field(const TraceResult& result, std::size_t index);

/// The same in the cells that were counted, `counted_parts` to a cell of the grid. Throws what CountedSphere
/// throws. About 130 bytes a cell.
CountedSphere counted_far_field(const TraceResult& result, std::size_t index);

/// Flux that left, direct and reflected, and without each replicate.
Jackknife out_flux(const TraceResult& result);

/// A figure by cell of a plane grid, numbered iy * nx + ix.
struct PlaneImage {
  std::string name;
  PlaneGrid grid;
  FluxUnit unit = FluxUnit::lumen;
  /// Illuminance in lx, or luminance in cd/m2 (W/m2 and W/(m2 sr) when `unit` is watt).
  std::vector<double> value;
  /// NaN where not known, as in Ledger.
  std::vector<double> standard_error;
  /// Flux that was counted, all cells, and its error.
  Estimate flux;
};

/// Illuminance on TraceResult::planes[index].
PlaneImage illuminance(const TraceResult& result, std::size_t index);
/// Luminance in TraceResult::luminances[index]: flux over `etendue_mm2sr` of the cell.
PlaneImage luminance(const TraceResult& result, std::size_t index);

/// Adds two traces of the same scene over different rays: the result is, to the bit, that of one run over
/// both, whatever the order. Throws InputError if they differ in seed, sequence, bounces, instruction set,
/// flux or detectors, or if their rays do not meet end to end (it says which rays are missing or double).
TraceResult merge(const TraceResult& a, const TraceResult& b);

}  // namespace lucerna
