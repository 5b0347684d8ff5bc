// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/lens_fit.h"
#include "lucerna/design/search/free_form_search.h"

namespace lucerna {

/// The search of the free-form last face over one base: that of free-form mirrors, with a face that refracts.
class FaceSearch {
 public:
  /// Begins with the face of `problem.start`.
  FaceSearch(const LensProblem& problem, const LensFitOptions& options);
  /// Begins with a face that was chosen among others. `flux_reference`: that of the search whose costs are
  /// compared with this one's.
  FaceSearch(const LensProblem& problem, const LensFitOptions& options, double flux_reference,
             const std::optional<DesignShape>& begin);
  FaceSearch(const FaceSearch&) = delete;
  FaceSearch& operator=(const FaceSearch&) = delete;

  FreeFormSearch& search() { return search_; }
  ShapedLens best() const { return {problem_.start, search_.best()}; }
  /// With the best face, as near to it as the limits allow. A design is not lost where no such face is found:
  /// the check of its limits says so.
  ShapedLens held() const;

  /// Share of the sources' flux that light in the target's rectangle is compared with.
  double flux_reference() const { return fit_.flux_reference * within_; }

  /// A face that a few steps made of a point source's, which begins at so many times the given face's
  /// distance from the source; by rays that go straight through. Nothing where there is none.
  struct RoughFace {
    DesignShape face;
    FitRecord record;
    /// Of few rays, less their noise.
    double cost;
  };
  std::optional<RoughFace> rough(double distance);

 private:
  double entered();
  FitProblem fit_problem(std::optional<double> flux_reference, bool is_chosen);
  double passed_by_start(const FitProblem& fit) const;
  Frame world_from_design() const { return problem_.world_from_lens * lens_from_design(); }
  FaceSearch(LensProblem problem, const LensFitOptions& options, std::optional<double> flux_reference,
             const DesignShape& begin, bool is_chosen);

  LensProblem problem_;
  DesignShape start_;
  FaceSeat seat_;
  std::shared_ptr<const ShapeLimits> limits_;
  DesignRays rays_;
  std::uint64_t seed_;
  /// Share of the sources' flux that comes into the medium.
  double within_;
  FitProblem fit_;
  FreeFormSearch search_;
};

}  // namespace lucerna
