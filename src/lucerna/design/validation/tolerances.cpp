// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/tolerances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/photometry/metrics/far_field_metrics.h"
#include "lucerna/random.h"
#include "lucerna/trace.h"
#include "lucerna/trace/metrics/backward_intensity.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {

namespace {

/// As fine as the scene's own detectors, and fine enough for beams of a few degrees.
FarFieldDetector watch(const Scene& scene) {
  FarFieldDetector d;
  d.name = "tolerances";
  d.c_step_deg = 15.0;
  d.gamma_step_deg = 1.0;
  for (const FarFieldDetector& own : scene.far_fields)
    d.gamma_step_deg = std::min(d.gamma_step_deg, own.gamma_step_deg);
  return d;
}

/// Takes half of the samples: a case takes a second or two then. All cases have the same random numbers, so
/// that differences between them have less noise.
PointIntensity with_fewer_samples(PointIntensity exact) {
  if (!exact) return {};
  return [exact = std::move(exact)](const Direction& d, std::uint64_t samples, std::uint64_t seed) {
    return exact(d, samples / 2, seed);
  };
}

/// Of one case. Light is followed backward where it can be, as for the design's own figures: cells alone are
/// too wide for the tip of a narrow beam.
ToleranceMetrics figures_of(const Scene& scene, const TraceOptions& options, const StopCheck& stop) {
  const TraceResult result = trace(scene, options);
  PointIntensity exact;
  if (ledger(result).reflections_per_ray.mean <= kMaxBackwardReflections)
    exact = with_fewer_samples(
        backward_intensity(scene, result.max_bounces, result.seed, far_field(result, 0), stop));
  const PeakAndBeam beam = peak_and_beam(counted_far_field(result, 0), exact);
  ToleranceMetrics f;
  f.efficiency = out_flux(result).map([&](double x) { return x / result.flux; }).estimate();
  if (beam.peak) f.peak = beam.peak->cd;
  f.centre = beam.axis_cd;
  f.beam_c0_deg = beam.beam_c0_deg;
  f.beam_c90_deg = beam.beam_c90_deg;
  return f;
}

using Figure = std::function<std::optional<Estimate>(const ToleranceMetrics&)>;

ToleranceSpread spread_of(const std::string& name, const ToleranceSweep& sweep, const Figure& figure) {
  ToleranceSpread s;
  s.figure = name;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  s.nominal = figure(sweep.figures.front()).value_or(Estimate{unknown, unknown});
  s.min.mean = std::numeric_limits<double>::infinity();
  s.max.mean = -s.min.mean;
  double sum = 0.0, squares = 0.0, errors = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < sweep.cases.size(); ++i) {
    const std::optional<Estimate> x = figure(sweep.figures[i]);
    if (sweep.cases[i].name.rfind("combined", 0) != 0 || !x) continue;
    sum += x->mean;
    squares += x->mean * x->mean;
    errors += x->standard_error;
    if (x->mean < s.min.mean) s.min = *x;
    if (x->mean > s.max.mean) s.max = *x;
    ++n;
  }
  s.cases = n;
  if (n == 0) {
    s.mean = s.min = s.max = s.standard_deviation = {unknown, unknown};
    return s;
  }
  // Of the same rays: the errors go together, and their mean is that of the mean.
  s.mean = {sum / n, errors / n};
  s.standard_deviation = {unknown, unknown};
  if (n < 2) return s;
  // Of n normal values a standard deviation is known to one part in sqrt(2 n - 2).
  const double deviation = std::sqrt(std::max(0.0, (squares - n * s.mean.mean * s.mean.mean) / (n - 1)));
  s.standard_deviation = {deviation, deviation / std::sqrt(2.0 * (n - 1))};
  return s;
}

bool changes_nothing(const ToleranceCase& c) {
  return c.shift_mm == Vec3{} && c.tilt_x_deg == 0.0 && c.tilt_y_deg == 0.0 && c.slope_error_mrad == 0.0 &&
         c.reflectance == 0.0;
}

/// The design itself, and what differs from it: ranges of 0 take no time.
std::vector<std::size_t> cases_to_trace(const std::vector<ToleranceCase>& cases) {
  std::vector<std::size_t> out{0};
  for (std::size_t i = 1; i < cases.size(); ++i) {
    if (!changes_nothing(cases[i])) out.push_back(i);
  }
  return out;
}

Vec3 middle(const Scene& scene) {
  Vec3 sum;
  for (const PlacedSource& s : scene.sources) sum += s.total_flux() * s.world_from_source.origin_mm();
  return sum / total_flux(scene.sources);
}

}  // namespace

ToleranceRanges read_tolerances(TomlReader reader) {
  ToleranceRanges r;
  r.source_shift_mm = reader.number("source_shift_mm", r.source_shift_mm);
  r.source_tilt_deg = reader.number("source_tilt_deg", r.source_tilt_deg);
  r.slope_error_mrad = reader.number("slope_error_mrad", r.slope_error_mrad);
  r.reflectance = reader.number("reflectance", r.reflectance);
  r.samples = static_cast<int>(reader.number("samples", r.samples));
  r.rays = static_cast<std::uint64_t>(reader.number("rays", static_cast<double>(r.rays)));
  reader.finish();
  return r;
}

std::vector<ToleranceCase> tolerance_cases(const ToleranceRanges& ranges, std::uint64_t seed) {
  std::vector<ToleranceCase> cases{{"nominal", {}}};
  const auto both_ways = [&](const std::string& name, double size, const auto& set) {
    for (const double sign : {1.0, -1.0}) {
      ToleranceCase c{name + (sign > 0.0 ? "+" : "-"), {}};
      set(c, sign * size);
      cases.push_back(std::move(c));
    }
  };
  both_ways("shift_x", ranges.source_shift_mm, [](ToleranceCase& c, double x) { c.shift_mm.x = x; });
  both_ways("shift_y", ranges.source_shift_mm, [](ToleranceCase& c, double x) { c.shift_mm.y = x; });
  both_ways("shift_z", ranges.source_shift_mm, [](ToleranceCase& c, double x) { c.shift_mm.z = x; });
  both_ways("tilt_x", ranges.source_tilt_deg, [](ToleranceCase& c, double x) { c.tilt_x_deg = x; });
  both_ways("tilt_y", ranges.source_tilt_deg, [](ToleranceCase& c, double x) { c.tilt_y_deg = x; });
  both_ways("reflectance", ranges.reflectance, [](ToleranceCase& c, double x) { c.reflectance = x; });
  ToleranceCase slope{"slope_error+", {}};
  slope.slope_error_mrad = ranges.slope_error_mrad;
  cases.push_back(slope);
  for (int i = 1; i <= ranges.samples; ++i) {
    Rng rng(seed, static_cast<std::uint64_t>(i));
    const auto even = [&](double size) { return size * (2.0 * rng.uniform() - 1.0); };
    ToleranceCase c{fmt::format("combined_{}", i), {}};
    c.shift_mm.x = even(ranges.source_shift_mm);
    c.shift_mm.y = even(ranges.source_shift_mm);
    c.shift_mm.z = even(ranges.source_shift_mm);
    c.tilt_x_deg = even(ranges.source_tilt_deg);
    c.tilt_y_deg = even(ranges.source_tilt_deg);
    c.slope_error_mrad = ranges.slope_error_mrad * rng.uniform();
    c.reflectance = even(ranges.reflectance);
    cases.push_back(std::move(c));
  }
  return cases;
}

Scene changed(const Scene& scene, const ToleranceCase& change) {
  Scene out = scene;
  const Vec3 centre = middle(scene);
  const Frame turn = Frame::rotation(Direction::from(Vec3{0, 1, 0}), radians(change.tilt_y_deg)) *
                     Frame::rotation(Direction::from(Vec3{1, 0, 0}), radians(change.tilt_x_deg));
  const Frame about(turn.ex(), turn.ey(), turn.ez(), centre + change.shift_mm - turn.vector(centre));
  for (PlacedSource& s : out.sources) s.world_from_source = about * s.world_from_source;
  for (PlacedReflector& r : out.reflectors) {
    r.slope_error_mrad = std::hypot(r.slope_error_mrad, change.slope_error_mrad);
    if (change.reflectance != 0.0) r.reflectance = r.reflectance.shifted(change.reflectance);
  }
  return out;
}

ToleranceSweep tolerance_sweep(const Scene& scene, const ToleranceRanges& ranges, std::uint64_t seed,
                               Progress& progress, Peers* peers) {
  ToleranceSweep sweep;
  sweep.ranges = ranges;
  sweep.cases = tolerance_cases(ranges, seed);
  TraceOptions options;
  options.seed = seed;
  options.last_ray = ranges.rays;
  Scene plain = scene;
  plain.far_fields = {watch(scene)};
  plain.planes.clear();
  plain.luminances.clear();
  plain.ray_detectors.clear();
  sweep.figures.resize(sweep.cases.size());
  const StopCheck stop(progress);
  const std::vector<std::size_t> traced = cases_to_trace(sweep.cases);
  // A case for each process at a time.
  const std::size_t all = traced.size(),
                    each = peers == nullptr ? 1 : static_cast<std::size_t>(peers->size());
  for (std::size_t first = 0; first < all; first += each) {
    if (progress.stop_requested()) throw Interrupted();
    const std::size_t n = std::min(each, all - first);
    const ItemRange own = own_items(peers, n);
    const auto figures = [&](std::size_t i) -> ToleranceMetrics& { return sweep.figures[traced[first + i]]; };
    for (std::size_t i = own.first; i < own.last; ++i)
      figures(i) = figures_of(changed(plain, sweep.cases[traced[first + i]]), options, stop);
    share_items(
        peers, n, StateKey().add(std::uint64_t{first}).value(),
        [&](std::size_t i, std::string& bytes) { append(bytes, std::vector{figures(i)}); },
        [&](std::size_t i, std::string_view& bytes) {
          std::vector<ToleranceMetrics> one;
          take(bytes, one);
          figures(i) = one.front();
        });
    progress.update("tolerances", first + n, all);
  }
  for (std::size_t i = 1; i < sweep.cases.size(); ++i) {
    if (changes_nothing(sweep.cases[i])) sweep.figures[i] = sweep.figures.front();
  }
  sweep.spread = {
      spread_of("efficiency", sweep, [](const ToleranceMetrics& f) { return f.efficiency; }),
      spread_of("peak", sweep, [](const ToleranceMetrics& f) { return f.peak; }),
      spread_of("centre", sweep, [](const ToleranceMetrics& f) { return f.centre; }),
      spread_of("beam_c0_deg", sweep, [](const ToleranceMetrics& f) { return f.beam_c0_deg; }),
      spread_of("beam_c90_deg", sweep, [](const ToleranceMetrics& f) { return f.beam_c90_deg; }),
  };
  return sweep;
}

std::string tolerances_csv(const ToleranceSweep& sweep) {
  std::string csv =
      "case,shift_x_mm,shift_y_mm,shift_z_mm,tilt_x_deg,tilt_y_deg,slope_error_mrad,reflectance";
  for (const char* figure : {"efficiency", "peak", "centre", "beam_c0_deg", "beam_c90_deg"})
    csv += fmt::format(",{0},{0}_standard_error", figure);
  csv += '\n';
  const auto columns = [](const std::optional<Estimate>& e) {
    return e ? fmt::format(",{:.6g},{:.2g}", e->mean, e->standard_error) : std::string(",,");
  };
  for (std::size_t i = 0; i < sweep.cases.size(); ++i) {
    const ToleranceCase& c = sweep.cases[i];
    const ToleranceMetrics& f = sweep.figures[i];
    csv +=
        fmt::format("{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}", c.name, c.shift_mm.x, c.shift_mm.y,
                    c.shift_mm.z, c.tilt_x_deg, c.tilt_y_deg, c.slope_error_mrad, c.reflectance);
    csv += columns(f.efficiency) + columns(f.peak) + columns(f.centre) + columns(f.beam_c0_deg) +
           columns(f.beam_c90_deg) + '\n';
  }
  return csv;
}

}  // namespace lucerna
