// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/radius_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::size_t kMinEstimates = 3;
constexpr double kHopelessNoise = 3.0;
/// Smaller differences are taken for noise.
constexpr double kSureErrors = 2.0;
/// A kernel is too wide if a narrower one differs by more errors of the difference.
constexpr double kRejectErrors = 3.0;

}  // namespace

void RadiusChoice::add(Jackknife values, double standard_error) {
  values_.push_back(std::move(values));
  noise_.push_back(standard_error);
}

double RadiusChoice::beyond_noise(std::size_t i, std::size_t k, double errors) const {
  Jackknife gap = values_[i];
  gap.add(-1.0, values_[k].values());
  const Estimate e = gap.estimate();
  return std::sqrt(std::max(0.0, e.mean * e.mean - std::pow(errors * e.standard_error, 2.0)));
}

double RadiusChoice::bias(std::size_t i) const {
  const std::size_t last = values_.size() - 1;
  if (last == 0) return 0.0;
  double max = 0.0;
  for (std::size_t k = i + 1; k <= last; ++k) max = std::max(max, beyond_noise(i, k, kSureErrors));
  return max + beyond_noise(last, last - 1, kSureErrors);
}

std::size_t RadiusChoice::widest_accepted() const {
  const std::size_t last = values_.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    bool agrees = true;
    for (std::size_t k = i + 1; k <= last; ++k) agrees = agrees && beyond_noise(i, k, kRejectErrors) == 0.0;
    if (agrees) return i;
  }
  return last;
}

RadiusChoice::Choice RadiusChoice::best() const {
  LUCERNA_CHECK(!values_.empty(), "no estimate");
  Choice out{0, values_[0], noise_[0], noise_[0]};
  if (std::isnan(noise_[0])) return out;
  out.index = widest_accepted();
  out.noise = noise_[out.index];
  out.error = std::hypot(out.noise, bias(out.index));
  out.values = values_[out.index].with_error(out.error);
  return out;
}

bool RadiusChoice::complete() const {
  if (noise_.empty()) return false;
  return std::isnan(noise_[0]) ||
         (noise_.size() >= kMinEstimates && noise_.back() > kHopelessNoise * best().noise);
}

}  // namespace lucerna
