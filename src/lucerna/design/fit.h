// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lucerna/design/large_scale.h"
#include "lucerna/design/residual_rows.h"
#include "lucerna/design/target_rectangle.h"
#include "lucerna/design/zone_cost.h"
#include "lucerna/progress.h"

namespace lucerna {

/// Where on the ladder a start begins: with few knots, which leave the details to what the light asks for;
/// with most of its own; or in the last stage, where it is known to be near.
enum class FitEntry { few_knots, own_knots, end };

/// A shape that a fit may begin with.
struct FitStart {
  DesignShape shape;
  FitEntry entry = FitEntry::few_knots;
  /// Relative RMS^2 with limits, in a third of the bins.
  double cost = 0.0;
};

/// What is fitted: all that stays the same while the shape changes.
struct FitProblem {
  DesignRays* rays = nullptr;
  Reflectance reflectance{1.0};
  /// Flux that the target puts into any bins over its window, as shares of the sources' flux.
  std::function<Eigen::VectorXd(const TentBins&)> target;
  /// The bins in which the result is judged.
  TentBins bins;
  TargetMode mode = TargetMode::shape;
  bool direct_light = true;
  /// In shape mode, where the scale is free, light beside the window would cost nothing: flux_weight * (1 -
  /// share in the window / flux_reference)^2 is added to the cost. Weight 0 = not.
  double flux_weight = 0.0, flux_reference = 1.0;
  /// What the limits cost at a shape, to be added to the squared error: 0 where all are held. Adds its
  /// residuals to `rows` unless null. Limits on light trace the first `rays` rays. Empty: no limits.
  std::function<double(const DesignShape&, std::uint64_t rays, ResidualRows* rows)> limits;
  /// Shapes to begin with, the most promising first; empty: the shape that the fit is made with.
  std::vector<FitStart> starts;
  /// So many of them are compared at the gate before the best goes on; further ones are the first restarts.
  std::size_t compared = 5;
  /// Rays that were traced to find them.
  std::uint64_t search_rays = 0;
  /// While the result is above the noise the fit restarts, alternately from `starts` and from the incumbent,
  /// perturbed (free forms: from the search for basins and from the incumbent). So many restarts in a row
  /// that gain nothing end it. 0: neither restarts nor a search.
  int max_failed_restarts = 6;
  /// Size of a perturbation, over the mirror's outer radius; those of the search are twice as large.
  double perturbation = 0.02;
  std::uint64_t seed = 1;
  /// Of the target, and where it is seen from.
  TargetRectangle rectangle;
  Frame mirror_from_world;
  /// Bounds on the light of zones; without cells: none. Free forms of many knots only.
  ZoneBands zones;
};

/// One step of the ladder from coarse to fine.
struct FitStage {
  int intervals_x = 1, intervals_y = 1;
  /// Bins across, and how much wider than the target's window they reach.
  int bins = 48;
  double widen = 1.0;
  std::uint64_t rays = 1 << 16;
  int max_steps = 30;
  /// The stage ends when the last two accepted steps gained less than this share of the error.
  double min_gain = 0.03;
  /// Weight of `roughness` in the cost.
  double smoothing = 0.0;
  /// Starts are compared here: only the best goes on, later restarts only where they beat it.
  bool gate = false;
  /// The knots are taken only where the stage before ended above the noise; else those of before stay.
  bool grow = false;
  /// Large scales of the light weigh more (large_scale.h), by so many half waves; 0: all alike.
  double waves = 0.0;
  /// Of the search for other basins, which only its own restarts pass. Such stages come first.
  bool search = false;
};

/// One line of a design's history.
struct FitRecord {
  int stage = 0, step = 0;
  std::uint64_t rays = 0;  ///< of this evaluation
  std::uint64_t total_rays = 0;
  int evaluations = 0;
  double error = 0.0, floor = 0.0;  ///< in the stage's bins
  double lambda = 0.0;
  bool accepted = true;
  double efficiency = 0.0;
  /// Of a search with several, the candidate; and the light in the target's rectangle.
  int candidate = 0;
  double in_rectangle = 0.0;
};

/// A shape that a fit keeps, with its cost; without parameters: none yet.
struct FitMark {
  double cost = 0.0, over_noise = 0.0;
  /// What ends are compared by: the cost, with light beside the window weighed less than on the way.
  double merit = 0.0;
  int intervals_x = 1, intervals_y = 1;
  std::vector<double> parameters;
  bool exists() const { return !parameters.empty(); }
};

/// All that a fit's next step depends on; a checkpoint holds exactly this.
struct FitState {
  std::vector<double> parameters;
  int intervals_x = 1, intervals_y = 1;
  int stage = 0, step = 0;
  double lambda = 1e-2;
  /// Costs after the last accepted steps of this stage, newest last.
  std::vector<double> costs;
  int evaluations = 0;
  std::uint64_t total_rays = 0;
  /// Error over noise where the last stage ended.
  double over_noise = 0.0;
  /// Starts and restarts that were begun so far; and how many restarts in a row have gained nothing.
  int starts = 1, failed_restarts = 0;
  /// Steps in a row that were refused.
  int refused = 0;
  /// The best at the gate, and at the end of the ladder.
  FitMark gate, best;
  /// Restarts of the search so far, and how many more there may be now; whether the present one is the twin
  /// of the one before; the best that any came to; and the cost that the next has to beat.
  int search_restarts = 0, search_restarts_left = 0;
  bool twin = false;
  FitMark found;
  double incumbent_cost = 0.0;
  /// What a global search before the fit has paid for so far (optimizer.h).
  std::vector<double> search_costs;
};

/// Levenberg-Marquardt through a list of stages. Every decision depends on the state alone, so that a fit
/// that is stopped after any step and taken up from its state goes on to the same bits.
class Fit {
 public:
  /// Starts with the first of the problem's starts, or at `shape`. `search_costs` is kept in the state.
  Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& shape,
      std::vector<double> search_costs = {});
  /// Goes on from a state of the same problem, stages and shape family.
  Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& family,
      const FitState& state);

  bool done() const { return state_.stage >= static_cast<int>(stages_.size()); }
  /// One trial step (one evaluation with derivatives, two where a stage begins).
  FitRecord step(Progress& progress = no_progress());

  /// How many rays that will trace.
  std::uint64_t next_rays() const { return done() ? 0 : (ready_ ? 1 : 2) * stage().rays; }

  const DesignShape& shape() const { return shape_; }
  /// The best so far: of those that came to the end, else to the gate, else the shape now.
  DesignShape best() const;
  /// Whether the best is as good as the noise of the last stage's rays lets one see.
  bool at_noise() const;
  const FitState& state() const { return state_; }

 private:
  void begin_stage(Progress& progress);
  void finish_stage();
  /// Whether the shape goes on beyond the gate.
  bool pass_gate();
  /// Whether the gate's best seems near the target, yet not in the right basin.
  bool worth_searching() const;
  /// The next restart of the search, or its end.
  void next_search_restart();
  void begin_search_restart();
  /// What comes after the last of the search's stages.
  void pass_search();
  /// Goes on with the best at the gate.
  void leave_gate();
  void perturb(double size_mm, std::uint64_t stream);
  void pass_end(const FitMark& now);
  void restart();
  FitMark mark() const;
  DesignShape shape_of(const FitMark& mark) const;
  /// Goes back to a shape that was kept.
  void take(const FitMark& mark);
  NormalEquations equations_at(const DesignShape& shape, const Evaluation& e) const;
  /// Of the ladder, after those of the search.
  std::size_t first_stage(int min_intervals) const;
  std::size_t gate_stage() const;
  void begin_with(const DesignShape& start, std::size_t stage);
  std::size_t stage_of(const FitStart& start) const;
  const FitStage& stage() const { return stages_[static_cast<std::size_t>(state_.stage)]; }
  Evaluation evaluate_at(const DesignShape& shape);
  bool stalled() const;

  FitProblem problem_;
  std::vector<FitStage> stages_;
  /// How many of them are the search's.
  std::size_t search_stages_ = 0;
  DesignShape family_, shape_;
  FitState state_;
  /// Of the current stage; empty until it begins.
  bool ready_ = false;
  TentBins bins_;
  Eigen::VectorXd target_;
  std::optional<LargeScale> scale_;
  Evaluation now_;
  NormalEquations equations_;
};

/// How a ladder of stages is made.
struct LadderOptions {
  /// Rays of the last stage at most.
  std::uint64_t rays = std::uint64_t{1} << 22;
  /// Begins with few knots in coarse bins; else the start is known to be near.
  bool far = true;
  /// How often the knots may be doubled beyond the shape's own where the light asks for it.
  int growth = 0;
};

/// Stages for a shape: knots up to its own (and beyond, with growth), bins up to the problem's, always enough
/// bins to tell all parameters apart.
std::vector<FitStage> ladder(const DesignShape& shape, const TentBins& bins, const LadderOptions& options);

}  // namespace lucerna
