// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/design/run/design.h"
#include "lucerna/design/validation/source_etendue.h"
#include "lucerna/design/validation/validation.h"

namespace lucerna {

/// The brightest cell of glare per unit of the emitted flux, in all light and in what met no mirror; 0
/// without a limit on it.
struct GlareFound {
  Estimate per_flux, direct_per_flux;
};

/// What a finished design says of its mirror. All that does not need the result is done at construction, so
/// that a search knows what time is left for it: the start's error and the étendue of the sources.
class ResultCheck {
 public:
  /// Both must outlive it. Validates the start with 2^20 rays at most, in a twentieth of the time.
  ResultCheck(const DesignProblem& problem, const DesignOptions& options, Progress& progress);

  /// Seconds that so many rays through the result will take, as the start's did.
  double seconds(std::uint64_t rays) const;

  /// Fills in what is said of `result.shape`: its error and the start's, where the light goes (by validate():
  /// fresh rays through the exported mesh), the limits as found, the bound, and the remarks. At most
  /// `max_rays` rays; `max_s` stops them earlier. Where what the search began with is the better, it becomes
  /// the result. `fit` gives the target's bins for the bound of the étendue.
  void fill(const FitProblem& fit, std::uint64_t max_rays, double max_s, DesignResult& result,
            Progress& progress);

 private:
  Validation validated(const DesignShape& shape, std::uint64_t min_rays, std::uint64_t max_rays, double max_s,
                       Progress& progress) const;
  DesignBound bound(const DesignShape& shape, const Validation& light);
  GlareFound set_error(std::uint64_t max_rays, double max_s, DesignResult& result, Progress& progress);

  const DesignProblem& problem_;
  const DesignOptions& options_;
  /// Other rays than the search's.
  DesignRays rays_;
  SourceEtendue etendue_;
  ErrorBoxes boxes_;
  std::vector<double> target_;
  Validation start_;
  /// Where glare is limited.
  std::optional<GlareCells> glare_;
};

}  // namespace lucerna
