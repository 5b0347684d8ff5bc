// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/result/plane_extremes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "lucerna/trace/result/jackknifed_quanta.h"

namespace lucerna {

namespace {

/// Cells that may be the largest of `sign` times the values.
std::vector<std::size_t> contenders(const PlaneImage& image, double sign) {
  constexpr std::size_t kMax = 2048;
  constexpr double kErrors = 6.0;
  const auto at = [&](std::size_t k) { return sign * image.value[k]; };
  std::size_t best = 0;
  for (std::size_t k = 1; k < image.value.size(); ++k) best = at(k) > at(best) ? k : best;
  std::vector<std::size_t> cells;
  for (std::size_t k = 0; k < image.value.size(); ++k) {
    const double error = std::fmax(image.standard_error[k], image.standard_error[best]);
    if (k == best || at(k) > at(best) - kErrors * error) cells.push_back(k);
  }
  if (cells.size() > kMax) {
    const auto order = [&](std::size_t a, std::size_t b) {
      return at(a) > at(b) || (at(a) == at(b) && a < b);
    };
    std::nth_element(cells.begin(), cells.begin() + kMax, cells.end(), order);
    cells.resize(kMax);
    std::sort(cells.begin(), cells.end());
  }
  return cells;
}

/// What PlaneImage has, cell by cell and without each replicate.
struct ImageBins {
  const TraceResult& result;
  std::size_t bins;
  const ImageParts& image;

  /// Of the counted light `flux` of a cell.
  Jackknife value(const JackknifedFlux& flux, std::size_t row, std::size_t cell, double sign) const {
    const double w = image.blend.weight_of(cell), counted = sign * (1.0 - w) * image.counted.value[cell];
    const double per_flux = flux.flux(row) > 0.0 ? counted / flux.flux(row) : 0.0;
    Jackknife out(flux.replicates());
    out.add(per_flux, flux.row(row));
    if (w > 0.0) out.add(sign * w, image.blend.values.row(cell));
    return out;
  }
  /// Of all cells together.
  Jackknife mean() const {
    const JackknifedFlux all =
        jackknifed_flux(result, 1, [&](const Tally& t, std::size_t) { return all_bins_of(t, bins); });
    const std::vector<double>& value = image.counted.value;
    const auto cells = static_cast<double>(value.size());
    const double sum = std::accumulate(value.begin(), value.end(), 0.0), w = image.blend.weight;
    Jackknife out(all.replicates());
    if (all.flux(0) > 0.0) out.add((1.0 - w) * sum / cells / all.flux(0), all.row(0));
    for (std::size_t k = 0; w > 0.0 && k < value.size(); ++k) out.add(w / cells, image.blend.values.row(k));
    return out;
  }
};

/// The largest of `sign` times the values, and its cell.
LargestFigure extreme(const ImageBins& b, double sign, std::size_t& cell) {
  const std::vector<std::size_t> cells = contenders(b.image.average, sign);
  const JackknifedFlux flux = jackknifed_flux(
      b.result, cells.size(), [&](const Tally& t, std::size_t k) { return bin_of(t, b.bins, cells[k]); });
  std::vector<Jackknife> values;
  for (std::size_t k = 0; k < cells.size(); ++k) values.push_back(b.value(flux, k, cells[k], sign));
  LargestFigure max = largest(values);
  cell = cells[max.index];
  return max;
}

PlaneExtremes extremes(const ImageBins& b) {
  PlaneExtremes out;
  std::size_t min_cell = 0;
  out.max = extreme(b, 1.0, out.max_cell).estimate;
  const LargestFigure min = extreme(b, -1.0, min_cell);
  out.min = {0.0 - min.estimate.mean, min.estimate.standard_error};
  const Jackknife means = b.mean();
  out.mean = means.estimate();
  if (!(means.all() > 0.0)) return out;
  const Estimate e = ratio(min.values.map([](double v) { return 0.0 - v; }), means).estimate();
  out.uniformity = Estimate{e.mean, std::fmax(e.standard_error, out.min.standard_error / means.all())};
  return out;
}

}  // namespace

PlaneExtremes illuminance_extremes(const TraceResult& result, std::size_t index, const ImageParts& image) {
  return extremes({result, result.far_fields.size() + index, image});
}

PlaneExtremes luminance_extremes(const TraceResult& result, std::size_t index, const ImageParts& image) {
  return extremes({result, result.far_fields.size() + result.planes.size() + index, image});
}

}  // namespace lucerna
