// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/search/free_form_state.h"

namespace lucerna {

/// A step of a candidate's rough level, and the state of a search that does nothing else.
struct RoughStep {
  FitRecord record;
  FreeFormState state;
};

/// The rough level of a candidate, fitted before its turn; without steps: it has no start.
struct RoughFit {
  int candidate = 0;
  TransportChoice transport;
  std::vector<RoughStep> steps;
};

/// As processes send it to each other: all bits are kept.
std::string message_of(const RoughFit& fit);
RoughFit rough_fit_of(std::string_view message);

/// Whether the rough level of a candidate is among `fits`; one that was to begin otherwise is another.
bool is_among(const std::vector<RoughFit>& fits, const FreeFormSnapshot& candidate);
/// Takes it from them, and with it those of candidates before it. It is among them.
RoughFit taken_from(std::vector<RoughFit>& fits, const FreeFormSnapshot& candidate);

/// The steps of a rough level in turn, as those of a search that had come to `before` when it began.
class RoughReplay {
 public:
  RoughReplay(RoughFit fit, const FreeFormState& before)
      : fit_(std::move(fit)), evaluations_(before.evaluations), rays_(before.total_rays) {}
  bool has_start() const { return !fit_.steps.empty(); }
  /// There is one more.
  RoughStep next();

 private:
  RoughFit fit_;
  int evaluations_;
  std::uint64_t rays_;
  std::size_t at_ = 0;
};

}  // namespace lucerna
