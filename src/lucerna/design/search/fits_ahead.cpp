// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/fits_ahead.h"

#include <algorithm>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/design/search/checkpoint.h"

namespace lucerna {

namespace {

/// Messages go between processes of one run: their states need no other key.
const std::string kNoKey = "ahead";

bool begins_as(const RoughFit& fit, const FreeFormSnapshot& candidate) {
  return fit.candidate == candidate.candidate && fit.transport.sign == candidate.transport.sign &&
         fit.transport.vertex_distance_mm == candidate.transport.vertex_distance_mm;
}

}  // namespace

std::string message_of(const RoughFit& fit) {
  std::string bytes;
  append(bytes, static_cast<std::uint64_t>(fit.candidate));
  append_double(bytes, fit.transport.sign);
  append_double(bytes, fit.transport.vertex_distance_mm);
  std::vector<FitRecord> records;
  for (const RoughStep& step : fit.steps) records.push_back(step.record);
  append(bytes, records);
  for (const RoughStep& step : fit.steps) append_text(bytes, checkpoint_text(step.state, kNoKey));
  return bytes;
}

RoughFit rough_fit_of(std::string_view message) {
  RoughFit fit;
  fit.candidate = static_cast<int>(take(message));
  fit.transport.sign = take_double(message);
  fit.transport.vertex_distance_mm = take_double(message);
  std::vector<FitRecord> records;
  take(message, records);
  for (const FitRecord& record : records)
    fit.steps.push_back({record, parse_search_checkpoint(take_text(message), kNoKey)});
  return fit;
}

bool is_among(const std::vector<RoughFit>& fits, const FreeFormSnapshot& candidate) {
  return std::any_of(fits.begin(), fits.end(), [&](const RoughFit& f) { return begins_as(f, candidate); });
}

RoughFit taken_from(std::vector<RoughFit>& fits, const FreeFormSnapshot& candidate) {
  const auto at =
      std::find_if(fits.begin(), fits.end(), [&](const RoughFit& f) { return begins_as(f, candidate); });
  LUCERNA_CHECK(at != fits.end(), "candidate {} was not fitted ahead", candidate.candidate);
  RoughFit fit = std::move(*at);
  std::erase_if(fits, [&](const RoughFit& f) { return f.candidate <= candidate.candidate; });
  return fit;
}

RoughStep RoughReplay::next() {
  LUCERNA_CHECK(at_ < fit_.steps.size(), "step {} of {}", at_, fit_.steps.size());
  RoughStep step = fit_.steps[at_++];
  step.state.evaluations += evaluations_;
  step.state.total_rays += rays_;
  step.record.evaluations = step.state.evaluations;
  step.record.total_rays = step.state.total_rays;
  return step;
}

}  // namespace lucerna
