// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/lens/cavity_search.h"
#include "lucerna/design/lens/lens_fit.h"

namespace lucerna {

/// A base of a lens, and the last face that a few steps made over it.
struct LensBase {
  /// The lens with that base, and with a last face to begin with where it has none here.
  LensShape outline;
  std::optional<DesignShape> face;
  /// Nothing: the given base.
  std::optional<Cavity> cavity;
  double cost = std::numeric_limits<double>::infinity();
};

/// Looks at the base of a lens and at cavities in its place (cavity_search.h), for a last face that is a free
/// form, and a first one that may become one.
class BaseChoice {
 public:
  /// The arguments must outlive it.
  BaseChoice(const LensProblem& problem, const LensFitOptions& options, const LensFitWatcher& watch);

  void run();

  /// Share of the sources' flux that light in the target's rectangle is compared with.
  double flux_reference() const { return flux_reference_; }
  /// The given one where none has a face to begin with.
  const LensBase& best() const { return bases_.front(); }
  /// The best one and others that are not much like it or each other: `count` at most, the best ones first.
  std::vector<LensBase> distinct(std::size_t count) const;
  int evaluations() const { return evaluations_; }
  std::uint64_t rays() const { return rays_; }
  /// The watcher has ended it.
  bool has_ended() const { return ended_; }

 private:
  std::optional<double> judged(const CavityTrial& trial, double draft_deg);
  double cost(LensBase base, double distance);

  const LensProblem& problem_;
  const LensFitOptions& options_;
  const LensFitWatcher& watch_;
  double flux_reference_;
  DesignRays source_;
  /// By their costs.
  std::vector<LensBase> bases_;
  int evaluations_ = 0;
  std::uint64_t rays_ = 0;
  bool ended_ = false;
};

/// The problem with another lens to begin with.
LensProblem with_start(const LensProblem& problem, LensShape start);

}  // namespace lucerna
