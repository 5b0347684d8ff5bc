// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/metrics/backward_blend.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "lucerna/core/math/units.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/estimate.h"
#include "lucerna/random.h"
#include "lucerna/trace/tally/wide_sums.h"

namespace lucerna {

namespace {

/// Forward rays that are traced in the time of a backward one.
constexpr std::uint64_t kForwardRays = 16;
/// A third of a second to some seconds.
constexpr std::uint64_t kMinRays = std::uint64_t{1} << 18, kMaxBackwardRays = std::uint64_t{1} << 21;
/// Cells that are looked at first, and the share of the average that is worth the others.
constexpr std::size_t kPilotCells = 64;
constexpr double kMinWeight = 0.2;
/// Backward and counted light agree within so many errors or this share of each other; cell by cell, the mean
/// of the squared differences over the errors is below a limit.
constexpr double kImageErrors = 4.0, kImageShare = 0.005, kMaxMeanSquare = 2.0;
/// Cells that are compared: counted errors are known where many rays were counted.
constexpr double kComparedShare = 0.05, kComparedError = 0.1;

/// Independent of the run's other numbers and detectors, one for each of its replicates.
std::vector<std::uint64_t> seeds_of(const TraceResult& result, std::uint64_t stream, std::size_t cell) {
  std::vector<std::uint64_t> seeds;
  const std::uint64_t first =
      detail::mix_bits(detail::mix_bits(detail::mix_bits(result.seed) + stream) + cell);
  for (std::size_t r = 0; r < result.replicates.size(); ++r) seeds.push_back(detail::mix_bits(first + r));
  return seeds;
}

/// The mean of one value a seed, and the means without each.
void leave_one_out(std::span<const double> values, std::span<double> row) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  const auto n = static_cast<double>(values.size());
  row[0] = sum / n;
  for (std::size_t r = 0; r < values.size(); ++r) row[r + 1] = (sum - values[r]) / (n - 1.0);
}

std::vector<std::size_t> brightest_first(const PlaneImage& image) {
  std::vector<std::size_t> cells(image.value.size());
  std::iota(cells.begin(), cells.end(), std::size_t{0});
  std::stable_sort(cells.begin(), cells.end(),
                   [&](std::size_t a, std::size_t b) { return image.value[a] > image.value[b]; });
  return cells;
}

/// Of the variances of the same cells. `one_ray` is what one ray more adds to a cell: counted light is not
/// known better, not even where there is none.
double weight_of(const PlaneImage& counted, const JackknifedFlux& values, std::span<const std::size_t> cells,
                 double one_ray) {
  double forward = 0.0, backward = 0.0;
  for (const std::size_t k : cells) {
    const double error = values.at(k).estimate().standard_error;
    forward += counted.standard_error[k] * counted.standard_error[k];
    backward += error * error;
  }
  forward = std::max(forward, one_ray * one_ray);
  return forward / (forward + backward);
}

bool agree(const PlaneImage& counted, const JackknifedFlux& values, double one_ray) {
  const double bright = kComparedShare * *std::max_element(counted.value.begin(), counted.value.end());
  double counted_sum = 0.0, squares = 0.0, compared = 0.0;
  Jackknife backward_sum(values.replicates());
  for (std::size_t k = 0; k < counted.value.size(); ++k) {
    counted_sum += counted.value[k];
    backward_sum.add(1.0, values.row(k));
    if (!(counted.value[k] > 0.0) || counted.value[k] < bright ||
        counted.standard_error[k] > kComparedError * counted.value[k])
      continue;
    const Estimate backward = values.at(k).estimate();
    const double gap = backward.mean - counted.value[k];
    const double variance = backward.standard_error * backward.standard_error +
                            counted.standard_error[k] * counted.standard_error[k];
    if (!(variance > 0.0)) continue;
    squares += gap * gap / variance;
    compared += 1.0;
  }
  const double counted_error =
      counted.flux.mean > 0.0 ? counted_sum * counted.flux.standard_error / counted.flux.mean : 0.0;
  const Estimate all = backward_sum.estimate();
  const double gap = std::abs(all.mean - counted_sum);
  return gap <= kImageErrors * std::hypot(all.standard_error, counted_error, one_ray) +
                    kImageShare * counted_sum &&
         squares <= kMaxMeanSquare * compared + 4.0 * std::sqrt(2.0 * compared);
}

/// `look(cell, samples, seeds)`: one value a seed, in the image's unit. `stream` numbers the detector.
template <class Look>
ImageBlend blend(const TraceResult& result, const PlaneImage& counted, double one_ray, std::uint64_t stream,
                 const StopCheck& stop, const Look& look) {
  const std::size_t count = counted.value.size(), seeds = result.replicates.size();
  const std::uint64_t rays =
      std::clamp((result.last_ray - result.first_ray) / kForwardRays, kMinRays, kMaxBackwardRays);
  const std::uint64_t samples = std::bit_floor(rays / (seeds * count));
  const auto used = std::count_if(result.replicates.begin(), result.replicates.end(),
                                  [](const Tally& t) { return emitted_of(t) > 0; });
  if (samples == 0 || static_cast<std::size_t>(used) != seeds) return {};
  ImageBlend out{0.0, JackknifedFlux(count, seeds)};
  const auto fill = [&](std::span<const std::size_t> cells) {
    parallel_blocks(cells.size(), 1, [&](std::size_t i, std::size_t) {
      stop();
      const std::size_t k = cells[i];
      leave_one_out(look(k, samples, seeds_of(result, stream, k)), out.values.row(k));
    });
  };
  const std::vector<std::size_t> order = brightest_first(counted);
  const std::span<const std::size_t> cells(order), pilot = cells.first(std::min(kPilotCells, count));
  fill(pilot);
  if (weight_of(counted, out.values, pilot, one_ray) < kMinWeight) return {};
  fill(cells.subspan(pilot.size()));
  if (agree(counted, out.values, one_ray)) out.weight = weight_of(counted, out.values, cells, one_ray);
  return out;
}

/// What one ray adds to a cell: its flux over the area (for luminance the étendue, mm^2 sr) of the cell.
double one_ray(const TraceResult& result, double cell_mm2) {
  return kSquareMillimetresPerSquareMetre * result.flux /
         static_cast<double>(result.last_ray - result.first_ray) / cell_mm2;
}

}  // namespace

ImageBlend backward_illuminance(const BackwardImage& backward, const TraceResult& result, std::size_t index,
                                const PlaneImage& counted, const StopCheck& stop) {
  const PlaneGrid& grid = result.planes[index].grid;
  if (!backward.can_see(grid)) return {};
  return blend(result, counted, one_ray(result, grid.cell_mm2()), index, stop,
               [&](std::size_t cell, std::uint64_t samples, std::span<const std::uint64_t> seeds) {
                 return backward.illuminance(grid, cell, samples, seeds);
               });
}

ImageBlend backward_luminance(const BackwardImage& backward, const TraceResult& result, std::size_t index,
                              const PlaneImage& counted, const StopCheck& stop) {
  const LuminanceDetector& detector = result.luminances[index];
  return blend(result, counted, one_ray(result, etendue_mm2sr(detector, 0)), result.planes.size() + index,
               stop, [&](std::size_t cell, std::uint64_t samples, std::span<const std::uint64_t> seeds) {
                 return backward.luminance(detector, cell, samples, seeds);
               });
}

}  // namespace lucerna
