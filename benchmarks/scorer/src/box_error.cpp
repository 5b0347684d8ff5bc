// SPDX-License-Identifier: Apache-2.0
#include "box_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bench {

namespace {

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The cells with a measure.
CellLight counting(const CellLight& cells) {
  CellLight out;
  out.by_replicate.resize(cells.by_replicate.size());
  for (std::size_t c = 0; c < cells.measure.size(); ++c) {
    if (cells.measure[c] == 0.0) continue;
    out.measure.push_back(cells.measure[c]);
    out.target.push_back(cells.target[c]);
    for (std::size_t r = 0; r < out.by_replicate.size(); ++r)
      out.by_replicate[r].push_back(cells.by_replicate[r][c]);
  }
  return out;
}

/// By cell, over the replicates.
std::vector<Estimate> means(const CellLight& cells) {
  std::vector<Estimate> out;
  std::vector<double> values(cells.by_replicate.size());
  for (std::size_t c = 0; c < cells.measure.size(); ++c) {
    for (std::size_t r = 0; r < values.size(); ++r) values[r] = cells.by_replicate[r][c];
    out.push_back(mean_of(values));
  }
  return out;
}

/// The scale that makes the error smallest once the noise in |f|^2 is taken out; 0 for a dark result.
double best_scale(const CellLight& cells, const std::vector<Estimate>& light) {
  double ft = 0.0, ff = 0.0, noise = 0.0;
  for (std::size_t c = 0; c < light.size(); ++c) {
    ft += light[c].mean * cells.target[c] / cells.measure[c];
    ff += light[c].mean * light[c].mean / cells.measure[c];
    noise += light[c].standard_error * light[c].standard_error / cells.measure[c];
  }
  // Where noise is nearly all of it, no scale is known well: a tenth is left.
  return ff > 0.0 ? ft / std::max(ff - noise, 0.1 * ff) : 0.0;
}

/// trace(S^2) of the covariance S of one replicate: products of different replicates' deviations have mean 0
/// and this variance.
double trace_of_square(const std::vector<std::vector<double>>& off) {
  std::vector<double> products;
  for (std::size_t r = 1; r < off.size(); ++r) {
    for (std::size_t s = 0; s < r; ++s) products.push_back(product(off[r], off[s]));
  }
  const double mean = mean_of(products).mean;
  double sum = 0.0;
  for (const double p : products) sum += (p - mean) * (p - mean);
  return sum / static_cast<double>(products.size());
}

Estimate worst_cell(const CellLight& cells, const std::vector<Estimate>& light, double scale) {
  Estimate worst;
  double peak = 0.0;
  for (std::size_t c = 0; c < light.size(); ++c) {
    peak = std::max(peak, cells.target[c] / cells.measure[c]);
    const double off = std::abs(scale * light[c].mean - cells.target[c]) / cells.measure[c];
    if (off > worst.mean) worst = {off, scale * light[c].standard_error / cells.measure[c]};
  }
  return {worst.mean / peak, worst.standard_error / peak};
}

}  // namespace

Estimate mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Estimate out;
  for (const double v : values) out.mean += v / n;
  double square = 0.0;
  for (const double v : values) square += (v - out.mean) * (v - out.mean);
  if (values.size() > 1) out.standard_error = std::sqrt(square / (n * (n - 1.0)));
  return out;
}

CellLight merged(const CellLight& fine, int rows, int n) {
  constexpr int kSide = 48;
  const int m = kSide / n, mv = rows == 1 ? 1 : m, out_rows = rows / mv;
  const auto cells = static_cast<std::size_t>(n * out_rows);
  CellLight out{std::vector<double>(cells, 0.0), std::vector<double>(cells, 0.0),
                std::vector<std::vector<double>>(fine.by_replicate.size(), std::vector<double>(cells, 0.0))};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const auto from = static_cast<std::size_t>(j * kSide + i);
      const auto to = static_cast<std::size_t>(j / mv * n + i / m);
      if (fine.measure[from] == 0.0) continue;
      out.measure[to] += fine.measure[from];
      out.target[to] += fine.target[from];
      for (std::size_t r = 0; r < out.by_replicate.size(); ++r)
        out.by_replicate[r][to] += fine.by_replicate[r][from];
    }
  }
  return out;
}

BoxError box_error(const CellLight& all) {
  const CellLight cells = counting(all);
  const std::vector<Estimate> light = means(cells);
  const std::size_t replicates = cells.by_replicate.size(), count = light.size();
  const auto n = static_cast<double>(replicates);
  BoxError out;
  out.scale = best_scale(cells, light);
  double norm2 = 0.0;
  for (std::size_t c = 0; c < count; ++c) norm2 += cells.target[c] * cells.target[c] / cells.measure[c];
  std::vector<double> mean(count);
  std::vector<std::vector<double>> off(replicates, std::vector<double>(count));
  for (std::size_t c = 0; c < count; ++c) {
    const double unit = 1.0 / std::sqrt(cells.measure[c] * norm2);
    mean[c] = (out.scale * light[c].mean - cells.target[c]) * unit;
    for (std::size_t r = 0; r < replicates; ++r)
      off[r][c] = out.scale * (cells.by_replicate[r][c] - light[c].mean) * unit;
  }
  const double square = product(mean, mean);
  double noise = 0.0, along = 0.0;
  for (const auto& x : off) {
    noise += product(x, x) / (n * (n - 1.0));
    along += std::pow(product(mean, x), 2) / (n * (n - 1.0));
  }
  // `along` is m'Sm / R and, by the noise in m, trace(S^2) / R^2: half of `pairs`.
  const double pairs = 2.0 * trace_of_square(off) / (n * n);
  const double sigma = std::sqrt(std::max(pairs, 4.0 * along - pairs));
  const double excess2 = std::max(0.0, square - noise);
  out.value = std::sqrt(square);
  out.floor = std::sqrt(noise);
  out.excess = std::sqrt(excess2);
  out.standard_error = sigma > 0.0 ? sigma / std::sqrt(4.0 * excess2 + sigma) : 0.0;
  out.worst = worst_cell(cells, light, out.scale);
  return out;
}

AbsoluteError absolute_error(const CellLight& cells) {
  const std::vector<Estimate> light = means(cells);
  double target = 0.0, result = 0.0;
  for (std::size_t c = 0; c < light.size(); ++c) {
    target += cells.target[c];
    result += light[c].mean;
  }
  AbsoluteError out;
  if (!(result > 0.0)) return {1.0, 0.0};
  for (std::size_t c = 0; c < light.size(); ++c) {
    out.value += std::abs(light[c].mean / result - cells.target[c] / target);
    // Mean size of a normal deviation.
    out.noise += std::sqrt(2.0 / std::numbers::pi) * light[c].standard_error / result;
  }
  return out;
}

Unevenness unevenness(const CellLight& all) {
  const CellLight cells = counting(all);
  const std::vector<Estimate> light = means(cells);
  const auto n = static_cast<double>(light.size());
  double mean = 0.0, square = 0.0, noise = 0.0;
  for (std::size_t c = 0; c < light.size(); ++c) mean += light[c].mean / cells.measure[c] / n;
  for (std::size_t c = 0; c < light.size(); ++c) {
    square += std::pow(light[c].mean / cells.measure[c] - mean, 2) / n;
    noise += std::pow(light[c].standard_error / cells.measure[c], 2) / n;
  }
  if (!(mean > 0.0)) return {};
  return {std::sqrt(square) / mean, std::sqrt(std::max(0.0, square - noise)) / mean};
}

}  // namespace bench
