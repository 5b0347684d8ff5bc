// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/jackknife.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

Jackknife::Jackknife(std::vector<double> values) : values_(std::move(values)) {
  LUCERNA_CHECK(!values_.empty(), "no value");
}

Estimate Jackknife::estimate() const {
  const auto n = static_cast<double>(replicates());
  if (replicates() < 2) return {all(), std::numeric_limits<double>::quiet_NaN()};
  double mean = 0.0, squares = 0.0;
  for (std::size_t r = 1; r < values_.size(); ++r) mean += values_[r] / n;
  for (std::size_t r = 1; r < values_.size(); ++r) squares += (values_[r] - mean) * (values_[r] - mean);
  return {all(), std::sqrt((n - 1.0) / n * squares)};
}

Jackknife Jackknife::draws() const {
  Jackknife out(*this);
  const double scale = replicates() < 2 ? 1.0 : std::sqrt(static_cast<double>(replicates()) - 1.0);
  for (std::size_t r = 1; r < values_.size(); ++r) out.values_[r] = all() + scale * (values_[r] - all());
  return out;
}

Jackknife Jackknife::from_draws(std::vector<double> values) {
  Jackknife out(std::move(values));
  const double scale = out.replicates() < 2 ? 1.0 : std::sqrt(static_cast<double>(out.replicates()) - 1.0);
  for (std::size_t r = 1; r < out.values_.size(); ++r)
    out.values_[r] = out.all() + (out.values_[r] - out.all()) / scale;
  return out;
}

Jackknife Jackknife::with_error(double error) const {
  Jackknife out(*this);
  const auto n = static_cast<double>(replicates());
  // Equal values have a scatter too, by rounding of their mean.
  constexpr double kRounding = 1e-12;
  const double before = estimate().standard_error;
  for (std::size_t r = 1; r < values_.size(); ++r) {
    double& v = out.values_[r];
    if (before > kRounding * std::abs(all())) {
      v = all() + (v - all()) * error / before;
    } else {
      v = all() + (r % 2 == 0 ? 1.0 : -1.0) * error / std::sqrt(n - 1.0);
    }
  }
  return out;
}

Estimate half_estimate(std::span<const double> values, bool odd) {
  const std::size_t replicates = values.size() - 1;
  LUCERNA_CHECK(replicates >= 4, "{} replicates", replicates);
  const auto n = static_cast<double>(replicates);
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t r = odd ? 1 : 2; r <= replicates; r += 2) {
    const double own = n * values[0] - (n - 1.0) * values[r];
    count += 1.0;
    sum += own;
    squares += own * own;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1.0))};
}

double error_of_rays(double value, double ray) { return std::sqrt(ray * (value + ray)); }

Jackknife ratio(const Jackknife& numerator, const Jackknife& denominator) {
  Jackknife out(numerator);
  for (std::size_t i = 0; i < out.values().size(); ++i) {
    const double d = denominator.values()[i];
    out.values()[i] = d == 0.0 ? 0.0 : out.values()[i] / d;
  }
  return out;
}

LargestFigure largest(std::span<const Jackknife> candidates) {
  LUCERNA_CHECK(!candidates.empty(), "nothing to choose from");
  const std::size_t replicates = candidates.front().replicates();
  const auto best = [&](std::size_t i) {
    std::size_t at = 0;
    for (std::size_t k = 1; k < candidates.size(); ++k) {
      if (candidates[k].values()[i] > candidates[at].values()[i]) at = k;
    }
    return at;
  };
  LargestFigure out;
  out.index = best(0);
  out.values = candidates[out.index];
  out.estimate = out.values.estimate();
  if (replicates < 2) return out;
  const auto n = static_cast<double>(replicates);
  double validated = 0.0;
  for (std::size_t r = 1; r <= replicates; ++r) {
    const std::size_t at = best(r);
    out.index_without.push_back(at);
    validated += (n * candidates[at].all() - (n - 1.0) * candidates[at].values()[r]) / n;
    out.values.values()[r] = candidates[at].values()[r];
  }
  // Cross-validation may come out above by chance; the two then agree within the error.
  const double gap = std::max(0.0, out.estimate.mean - validated);
  for (double& v : out.values.values()) v -= 0.5 * gap;
  out.estimate.mean -= 0.5 * gap;
  out.estimate.standard_error = std::hypot(out.estimate.standard_error, gap / std::sqrt(12.0));
  return out;
}

std::vector<double> JackknifedFlux::fluxes() const {
  std::vector<double> out(cells());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = flux(i);
  return out;
}

}  // namespace lucerna
