// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/metrics/backward_blend.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/estimate.h"
#include "lucerna/random.h"
#include "lucerna/trace/backward/backward_image.h"

namespace lucerna {

namespace {

/// Forward rays that are traced in the time of a backward one.
constexpr std::uint64_t kForwardRays = 16;
constexpr std::uint64_t kMinRays = std::uint64_t{1} << 18;
/// Cells that are looked at first, and the share of the average that is worth the others.
constexpr std::size_t kPilotCells = 64;
constexpr double kMinWeight = 0.2;
/// Backward and counted light agree within so many errors or this share of each other; cell by cell, the mean
/// of the squared differences over the errors is below a limit.
constexpr double kImageErrors = 4.0, kImageShare = 0.005, kMaxMeanSquare = 2.0;
/// Cells that are compared: counted errors are known where many rays were counted.
constexpr double kComparedShare = 0.05, kComparedError = 0.1;

/// Independent of the run's other numbers, one for each of its replicates.
std::vector<std::uint64_t> seeds_of(const TraceResult& result, std::size_t cell) {
  std::vector<std::uint64_t> seeds;
  const std::uint64_t stream = detail::mix_bits(detail::mix_bits(result.seed) + cell);
  for (std::size_t r = 0; r < result.replicates.size(); ++r) seeds.push_back(detail::mix_bits(stream + r));
  return seeds;
}

/// The mean of one value a seed, and the means without each.
void leave_one_out(std::span<const double> values, std::span<double> row) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  const auto n = static_cast<double>(values.size());
  row[0] = sum / n;
  for (std::size_t r = 0; r < values.size(); ++r) row[r + 1] = (sum - values[r]) / (n - 1.0);
}

Estimate estimate_of(std::span<const double> row) { return Jackknife({row.begin(), row.end()}).estimate(); }

/// The brightest cells of an image.
std::vector<std::size_t> brightest(const PlaneImage& image, std::size_t max) {
  std::vector<std::size_t> cells(image.value.size());
  std::iota(cells.begin(), cells.end(), std::size_t{0});
  const std::size_t n = std::min(max, cells.size());
  std::partial_sort(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(n), cells.end(),
                    [&](std::size_t a, std::size_t b) {
                      return image.value[a] > image.value[b] || (image.value[a] == image.value[b] && a < b);
                    });
  cells.resize(n);
  return cells;
}

/// Of the variances of the same cells.
double weight_of(const PlaneImage& counted, const JackknifedFlux& values,
                 std::span<const std::size_t> cells) {
  double forward = 0.0, backward = 0.0;
  for (const std::size_t k : cells) {
    const double error = estimate_of(values.row(k)).standard_error;
    forward += counted.standard_error[k] * counted.standard_error[k];
    backward += error * error;
  }
  return forward > 0.0 ? forward / (forward + backward) : 0.0;
}

bool agree(const PlaneImage& counted, const JackknifedFlux& values) {
  const double bright = kComparedShare * *std::max_element(counted.value.begin(), counted.value.end());
  double counted_sum = 0.0, squares = 0.0, compared = 0.0;
  Jackknife backward_sum(values.replicates());
  for (std::size_t k = 0; k < counted.value.size(); ++k) {
    counted_sum += counted.value[k];
    backward_sum.add(1.0, values.row(k));
    if (counted.value[k] < bright || counted.standard_error[k] > kComparedError * counted.value[k]) continue;
    const Estimate backward = estimate_of(values.row(k));
    const double gap = backward.mean - counted.value[k];
    squares +=
        gap * gap /
        (backward.standard_error * backward.standard_error +
         counted.standard_error[k] * counted.standard_error[k] + 1e-12 * counted.value[k] * counted.value[k]);
    compared += 1.0;
  }
  const double counted_error =
      counted.flux.mean > 0.0 ? counted_sum * counted.flux.standard_error / counted.flux.mean : counted_sum;
  const Estimate all = backward_sum.estimate();
  const double gap = std::abs(all.mean - counted_sum);
  return gap <= kImageErrors * std::hypot(all.standard_error, counted_error) + kImageShare * counted_sum &&
         squares <= kMaxMeanSquare * compared + 4.0 * std::sqrt(2.0 * compared);
}

/// `look(cell, samples, seeds)`: one value a seed, in the image's unit.
template <class Look>
ImageBlend blend(const TraceResult& result, const PlaneImage& counted, const Look& look) {
  const std::size_t cells = counted.value.size(), seeds = result.replicates.size();
  const std::uint64_t rays = std::max(kMinRays, (result.last_ray - result.first_ray) / kForwardRays);
  const std::uint64_t samples = std::bit_floor(rays / (seeds * cells));
  const auto used = std::count_if(result.replicates.begin(), result.replicates.end(),
                                  [](const Tally& t) { return t.emitted > 0; });
  if (samples == 0 || static_cast<std::size_t>(used) != seeds) return {};
  ImageBlend out{0.0, JackknifedFlux(cells, seeds)};
  const auto fill = [&](std::size_t k) {
    leave_one_out(look(k, samples, seeds_of(result, k)), out.values.row(k));
  };
  const std::vector<std::size_t> pilot = brightest(counted, kPilotCells);
  parallel_blocks(pilot.size(), 1, [&](std::size_t i, std::size_t) { fill(pilot[i]); });
  if (weight_of(counted, out.values, pilot) < kMinWeight) return {};
  parallel_blocks(cells, 1, [&](std::size_t k, std::size_t) { fill(k); });
  if (!agree(counted, out.values)) return {};
  out.weight = weight_of(counted, out.values, brightest(counted, cells));
  return out;
}

}  // namespace

ImageBlend backward_illuminance(const Scene& scene, const TraceResult& result, std::size_t index,
                                const PlaneImage& counted) {
  if (!no_backward_reason(scene).empty()) return {};
  const BackwardImage backward(scene, result.max_bounces);
  const PlaneGrid& grid = result.planes[index].grid;
  if (!backward.can_see(grid)) return {};
  return blend(result, counted,
               [&](std::size_t cell, std::uint64_t samples, std::span<const std::uint64_t> seeds) {
                 return backward.illuminance(grid, cell, samples, seeds);
               });
}

ImageBlend backward_luminance(const Scene& scene, const TraceResult& result, std::size_t index,
                              const PlaneImage& counted) {
  if (!no_backward_reason(scene).empty()) return {};
  const BackwardImage backward(scene, result.max_bounces);
  return blend(result, counted,
               [&](std::size_t cell, std::uint64_t samples, std::span<const std::uint64_t> seeds) {
                 return backward.luminance(result.luminances[index], cell, samples, seeds);
               });
}

}  // namespace lucerna
