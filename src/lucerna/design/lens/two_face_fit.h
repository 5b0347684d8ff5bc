// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lucerna/design/fit/free_form_fit.h"
#include "lucerna/design/lens/lens_fit.h"

namespace lucerna {

/// Fits a lens whose first and last face are free forms, in turn: a few steps of the last one with the rays
/// that the first one lets in, then of the first one, whose light goes on through the last. Each face sees
/// the same rays, target, limits and weight of light as a single free face (FaceSearch). Levels have more and
/// more rays and bins; one ends when a turn of both gains little.
class TwoFaceFit {
 public:
  /// `begin` has both faces. `levels`: how finely they are fitted, one level after the other (their knots do
  /// not count); in fewer bins where derivatives would be noise in all of them. `flux_reference`: share of
  /// the sources' flux that light in the target's rectangle is compared with. `problem` must outlive it.
  TwoFaceFit(const LensProblem& problem, std::uint64_t seed, ShapedLens begin,
             std::vector<FreeFormLevel> levels, double flux_reference);

  /// So many turns of both faces with few rays. Returns the cost that they come to, less its noise; nothing
  /// where the watcher ends it.
  std::optional<double> look(int turns, const LensFitWatcher& watch, LensFitResult& result);

  /// Runs until the watcher ends it, or the last level does; the result's lens is what is held then.
  void run(const LensFitWatcher& watch, LensFitResult& result);

  /// The lens so far, within its limits or as near to them as was found.
  ShapedLens held() const;

 private:
  /// What belongs to one of the faces.
  struct Side {
    std::unique_ptr<DesignRays> rays;
    bool is_entry = false;
    double lambda = 1e-2;
    /// Of its last point.
    double cost = 0.0;
  };

  DesignShape& shape(const Side& side) { return *(side.is_entry ? lens_.entry : lens_.face); }
  /// The light that the other face makes of the sources'. Returns the share of their flux that its
  /// evaluations are shares of.
  double prepare(Side& side, std::uint64_t count);
  ShapeLimits limits_of(const Side& side, int rings) const;
  FitProblem fit_problem(const Side& side, double within, std::shared_ptr<const ShapeLimits> limits) const;
  /// The level in as many bins as derivatives are known in.
  FreeFormLevel level_of(int number) const;
  /// Looks at the light to begin with, in few bins, for the first level.
  void look_at_noise(LensFitResult& result);
  void note_noise(const FreeFormLevel& level, const FreeFormPoint& point);
  /// Steps of one face; false where the watcher ends it.
  bool turn(Side& side, int number, const FreeFormLevel& level, const LensFitWatcher& watch,
            LensFitResult& result);
  /// Turns of both, until they gain little.
  bool run_level(int number, const LensFitWatcher& watch, LensFitResult& result);
  static FitRecord measured(const FreeFormFit& fit, const FreeFormPoint& point, double within);

  const LensProblem& problem_;
  std::uint64_t seed_;
  ShapedLens lens_;
  std::vector<FreeFormLevel> levels_;
  double flux_reference_;
  SourceEnd source_end_;
  Side entry_, last_;
  /// Light of other ways, of the lens that a level began with; empty until then.
  Eigen::VectorXd other_light_;
  /// Of the derivatives, over the rest, for one ray and one bin across.
  double noise_ = 0.0;
};

}  // namespace lucerna
