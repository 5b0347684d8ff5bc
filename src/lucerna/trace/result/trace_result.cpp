// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/math/units.h"
#include "lucerna/trace.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/result/addition.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace/result/jackknifed_quanta.h"
#include "lucerna/trace/tally/wide_sums.h"

namespace lucerna {

namespace {

/// Turns sums of units into flux, with the standard error that the spread between replicates gives: the ratio
/// estimator X / E with X_r and E_r by replicate has the variance R / (R - 1) * sum (X_r - E_r X / E)^2 / E^2
/// (W. G. Cochran, "Sampling Techniques", 3rd ed., section 6.3).
class Normaliser {
 public:
  explicit Normaliser(const TraceResult& result) : result_(result) {
    for (const Tally& t : result.replicates) {
      emitted_ += static_cast<double>(emitted_of(t));
      if (t.rays > 0) ++used_;
    }
    LUCERNA_CHECK(emitted_ > 0.0, "nothing was emitted");
    per_unit_ = result.flux / emitted_;
  }

  template <class Pick>
  Estimate estimate(const Pick& pick) const {
    Int128 sum = 0;
    for (const Tally& t : result_.replicates) sum += pick(t);
    const double ratio = static_cast<double>(sum) / emitted_;
    Estimate e{static_cast<double>(sum) * per_unit_, std::numeric_limits<double>::quiet_NaN()};
    if (used_ < 2) return e;
    double squares = 0.0;
    for (const Tally& t : result_.replicates) {
      const double d = static_cast<double>(pick(t)) - ratio * static_cast<double>(emitted_of(t));
      squares += d * d;
    }
    e.standard_error = std::sqrt(squares * used_ / (used_ - 1.0)) * per_unit_;
    return e;
  }

 private:
  const TraceResult& result_;
  double emitted_ = 0.0, per_unit_ = 0.0, used_ = 0.0;
};

/// Reflections over rays, a ratio estimator like the others.
Estimate reflections_per_ray(const TraceResult& result) {
  double reflections = 0.0, rays = 0.0, used = 0.0, squares = 0.0;
  for (const Tally& t : result.replicates) {
    reflections += static_cast<double>(t.reflections);
    rays += static_cast<double>(t.rays);
    if (t.rays > 0) used += 1.0;
  }
  const double ratio = reflections / rays;
  for (const Tally& t : result.replicates) {
    const double d = static_cast<double>(t.reflections) - ratio * static_cast<double>(t.rays);
    squares += d * d;
  }
  return {ratio, used < 2.0 ? std::numeric_limits<double>::quiet_NaN()
                            : std::sqrt(squares * used / (used - 1.0)) / rays};
}

}  // namespace

Ledger ledger(const TraceResult& result) {
  const Normaliser normal(result);
  Ledger l;
  l.unit = result.unit;
  l.emitted = result.flux;
  l.out_direct = normal.estimate(out_direct_of);
  l.out_reflected = normal.estimate(out_reflected_of);
  std::vector<std::string> absorbed{"mirror", "mirror_back"};
  absorbed.insert(absorbed.end(), result.body_names.begin(), result.body_names.end());
  for (std::size_t i = 0; i < absorbed.size(); ++i) {
    l.absorbed.emplace_back(absorbed[i], normal.estimate([i](const Tally& t) { return absorbed_of(t, i); }));
  }
  const char* const lost[kLostCauses] = {"bounce_limit", "not_finite"};
  for (std::size_t i = 0; i < kLostCauses; ++i) {
    l.lost.emplace_back(lost[i], normal.estimate([i](const Tally& t) { return lost_of(t, i); }));
  }
  l.all_lost = normal.estimate([](const Tally& t) {
    Int128 sum = 0;
    for (std::size_t i = 0; i < t.lost.size(); ++i) sum += lost_of(t, i);
    return sum;
  });
  for (const Tally& t : result.replicates) {
    l.rays += t.rays;
    for (const std::uint64_t n : t.lost_rays) l.lost_rays += n;
  }
  l.reflections_per_ray = reflections_per_ray(result);
  return l;
}

CountedFarField far_field(const TraceResult& result, std::size_t index) {
  LUCERNA_CHECK(index < result.far_fields.size(), "index = {}", index);
  const FarFieldDetector& detector = result.far_fields[index];
  const FarFieldGrid grid(detector), counted = FarFieldGrid::counted(detector);
  const FarFieldParts parts = counted_parts(detector);
  const std::size_t gammas = grid.gamma_count();
  CountedFarField f{{detector.name,
                     detector.c_step_deg,
                     detector.gamma_step_deg,
                     grid.c_count(),
                     gammas,
                     detector.tent,
                     result.unit,
                     {},
                     std::vector<double>(grid.size())},
                    jackknifed_flux(result, grid.size(), [&](const Tally& t, std::size_t cell) {
                      const std::size_t c = cell / gammas * parts.c + counted.c_count() - parts.c / 2;
                      const std::size_t g = cell % gammas * parts.gamma, half = parts.gamma / 2;
                      const std::size_t from = g < half ? 0 : g - half,
                                        to = std::min(g + half + 1, counted.gamma_count());
                      Int128 sum = 0;
                      for (std::size_t k = 0; k < parts.c; ++k) {
                        const std::size_t plane = (c + k) % counted.c_count() * counted.gamma_count();
                        for (std::size_t i = plane + from; i < plane + to; ++i) sum += bin_of(t, index, i);
                      }
                      return sum;
                    })};
  f.flux = f.replicated.fluxes();
  for (std::size_t i = 0; i < grid.size(); ++i)
    f.standard_error[i] = f.replicated.at(i).estimate().standard_error;
  return f;
}

CountedSphere counted_far_field(const TraceResult& result, std::size_t index) {
  LUCERNA_CHECK(index < result.far_fields.size(), "index = {}", index);
  const FarFieldGrid counted = FarFieldGrid::counted(result.far_fields[index]);
  return CountedSphere(counted.c_count(), counted.gamma_count(), result.unit,
                       jackknifed_flux(result, counted.size(), [&](const Tally& t, std::size_t cell) {
                         return bin_of(t, index, cell);
                       }));
}

Jackknife out_flux(const TraceResult& result) {
  return jackknifed_flux(result, 1,
                         [](const Tally& t, std::size_t) { return out_direct_of(t) + out_reflected_of(t); })
      .at(0);
}

namespace {

/// `per_flux(cell)` turns flux into the figure.
template <class PerFlux>
PlaneImage image(const TraceResult& result, std::size_t bins, const std::string& name, const PlaneGrid& grid,
                 const PerFlux& per_flux) {
  PlaneImage i{name, grid, result.unit, std::vector<double>(grid.size()), std::vector<double>(grid.size()),
               {}};
  const Normaliser normal(result);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Estimate e = normal.estimate([&](const Tally& t) { return bin_of(t, bins, k); });
    const double factor = kSquareMillimetresPerSquareMetre * per_flux(k);
    i.value[k] = e.mean * factor;
    i.standard_error[k] = e.standard_error * factor;
  }
  i.flux = normal.estimate([&](const Tally& t) { return all_bins_of(t, bins); });
  return i;
}

}  // namespace

PlaneImage illuminance(const TraceResult& result, std::size_t index) {
  LUCERNA_CHECK(index < result.planes.size(), "index = {}", index);
  const PlaneDetector& d = result.planes[index];
  return image(result, result.far_fields.size() + index, d.name, d.grid,
               [&](std::size_t) { return 1.0 / d.grid.cell_mm2(); });
}

PlaneImage luminance(const TraceResult& result, std::size_t index) {
  LUCERNA_CHECK(index < result.luminances.size(), "index = {}", index);
  const LuminanceDetector& d = result.luminances[index];
  return image(result, result.far_fields.size() + result.planes.size() + index, d.name, d.grid,
               [&](std::size_t cell) { return 1.0 / etendue_mm2sr(d, cell); });
}

/// The kept rays of two traces in the order of one run. Where both have rays of one block and source, those
/// of `first` come first.
void join_rays(const TraceResult& first, const TraceResult& second, TraceResult& sum) {
  sum.out_rays = RayBlock();
  sum.out_runs.clear();
  sum.out_rays.reserve(first.out_rays.size() + second.out_rays.size());
  std::size_t next[2] = {0, 0}, at[2] = {0, 0};
  const TraceResult* parts[2] = {&first, &second};
  const auto key = [&](std::size_t part) {
    const OutRun& run = parts[part]->out_runs[next[part]];
    return std::pair(run.block, run.source);
  };
  while (next[0] < first.out_runs.size() || next[1] < second.out_runs.size()) {
    const bool has_first = next[0] < first.out_runs.size(), has_second = next[1] < second.out_runs.size();
    const std::size_t part = has_first && (!has_second || key(0) <= key(1)) ? 0 : 1;
    const OutRun run = parts[part]->out_runs[next[part]++];
    for (std::uint32_t i = 0; i < run.rays; ++i) sum.out_rays.append(parts[part]->out_rays, at[part]++);
    const bool same_run = !sum.out_runs.empty() && sum.out_runs.back().block == run.block &&
                          sum.out_runs.back().source == run.source;
    if (same_run) {
      sum.out_runs.back().rays += run.rays;
    } else {
      sum.out_runs.push_back(run);
    }
  }
}

namespace {

/// What is wrong with the ranges of two traces; nothing if they meet end to end.
std::string range_fault(const TraceResult& a, const TraceResult& b) {
  const TraceResult &low = a.first_ray <= b.first_ray ? a : b, &high = &low == &a ? b : a;
  if (low.last_ray == high.first_ray) return "";
  if (low.last_ray < high.first_ray)
    return fmt::format("rays {}:{} are missing", low.last_ray, high.first_ray);
  return fmt::format("rays {}:{} are in both", high.first_ray, std::min(low.last_ray, high.last_ray));
}

}  // namespace

void check_addable(const TraceResult& a, const TraceResult& b) {
  const auto need = [](bool same, const char* what) {
    if (!same)
      throw InputError(fmt::format("the traces cannot be added: they differ in {}", what),
                       ErrorCause::mismatch);
  };
  if (a.seed != b.seed || a.sequence != b.sequence) {
    throw InputError(
        fmt::format("the traces cannot be added: one has seed {} and sequence {}, the other seed {} "
                    "and sequence {}",
                    a.seed, to_string(a.sequence), b.seed, to_string(b.sequence)),
        ErrorCause::mismatch);
  }
  need(a.max_bounces == b.max_bounces, "the limit of bounces");
  if (a.isa != b.isa) {
    throw InputError(
        fmt::format("the traces cannot be added: one was made with {}, the other with {}", a.isa, b.isa),
        ErrorCause::mismatch);
  }
  need(a.flux == b.flux && a.unit == b.unit, "the sources' flux");
  need(a.body_names == b.body_names, "bodies");
  need(a.far_fields == b.far_fields && a.planes == b.planes && a.luminances == b.luminances &&
           a.ray_detectors == b.ray_detectors && a.replicates.size() == b.replicates.size(),
       "detectors");
  for (const TraceResult* part : {&a, &b}) {
    if (part->out_runs.empty() && !part->out_rays.empty())
      throw InputError("the traces cannot be added: an accelerator keeps rays without their numbers",
                       ErrorCause::mismatch);
  }
}

TraceResult merge(const TraceResult& a, const TraceResult& b) {
  check_addable(a, b);
  if (const std::string fault = range_fault(a, b); !fault.empty())
    throw InputError("the traces cannot be added: " + fault, ErrorCause::mismatch);
  const bool a_first = a.first_ray < b.first_ray;
  TraceResult sum = a;
  sum.first_ray = std::min(a.first_ray, b.first_ray);
  sum.last_ray = std::max(a.last_ray, b.last_ray);
  for (std::size_t r = 0; r < sum.replicates.size(); ++r) sum.replicates[r] += b.replicates[r];
  if (!sum.ray_detectors.empty()) join_rays(a_first ? a : b, a_first ? b : a, sum);
  return sum;
}

}  // namespace lucerna
