// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/error.h"
#include "lucerna/design/limits.h"
#include "lucerna/design/perturbed.h"
#include "lucerna/design/roughness.h"
#include "lucerna/design/twin.h"
#include "lucerna/design/window.h"
#include "lucerna/design/zero_etendue.h"

namespace lucerna {

namespace {

/// A start is good when its error is at most this many times the noise: above it something is left to gain.
constexpr double kGateFloors = 1.5;

/// The fit is at its end where its squared error is at most the noise's and this share more, or twice the
/// scatter of the noise's own estimate if that is more (48 rings tell it to 20 % only).
constexpr double kEndShare = 0.1;

/// Steps in a row, each five times as damped as the one before, after which a stage is at its end.
constexpr int kMaxRefused = 5;

/// A restart has failed unless it brings the error down to this share of the incumbent's.
constexpr double kGain = 0.97;

/// Knots (per direction) that a zero-etendue solution begins with: more only follow its facets.
constexpr int kKnotsOfStarts = 4;

/// A shape above so many times the noise at the gate, but with less than this error, is near the target in
/// what seems another basin: the search looks for the right one, with so many restarts before the fit goes on
/// and so many in a restart of the fit.
constexpr double kSettledFloors = 1.15, kNearError = 0.06;
constexpr int kSearchRestartsAtGate = 24, kSearchRestartsLater = 3;

/// A restart of the search goes on to the gate where its error is at most this share of the incumbent's.
constexpr double kSearchGain = 0.95;

/// A restart of the search that ends above so many times the incumbent's error is so far off that its twin is
/// too.
constexpr double kTwinShare = 1.4;

/// Size of the search's perturbations, in those of the fit's restarts.
constexpr double kSearchPerturbation = 2.0;

/// Random streams of the search begin here, beyond those of the fit's restarts.
constexpr std::uint64_t kSearchStream = std::uint64_t{1} << 33;

/// Rays that tell where the source is.
constexpr std::uint64_t kSourceRays = 1 << 13;

/// Longest change of a height in one step, over the mirror's radius: the model of a step is not good for
/// more.
constexpr double kLongestStep = 0.05;

/// FitProblem::flux_weight, where ends are compared: on the way light must not get lost for a little less
/// error, but of two mirrors at the end the one whose light is right is wanted. A tenth of the light counts
/// as 1 %.
constexpr double kFluxWeightOfEnds = 0.01;

Eigen::VectorXd to_eigen(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

std::size_t count_search(const std::vector<FitStage>& stages) {
  std::size_t n = 0;
  while (n < stages.size() && stages[n].search) ++n;
  LUCERNA_CHECK(n < stages.size(), "a fit without stages");
  return n;
}

}  // namespace

Fit::Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& shape,
         std::vector<double> search_costs)
    : problem_(problem),
      stages_(std::move(stages)),
      search_stages_(count_search(stages_)),
      family_(shape),
      shape_(shape),
      bins_(problem.bins) {
  if (problem_.starts.empty()) problem_.starts = {{shape}};
  state_.search_costs = std::move(search_costs);
  state_.evaluations = static_cast<int>(state_.search_costs.size());
  state_.total_rays = problem_.search_rays;
  begin_with(problem_.starts[0].shape, stage_of(problem_.starts[0]));
}

Fit::Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& family,
         const FitState& state)
    : problem_(problem),
      stages_(std::move(stages)),
      search_stages_(count_search(stages_)),
      family_(family),
      shape_(family_.refined(state.intervals_x, state.intervals_y).with(to_eigen(state.parameters))),
      state_(state),
      bins_(problem.bins) {
  if (problem_.starts.empty()) problem_.starts = {{family}};
}

std::size_t Fit::first_stage(int min_intervals) const {
  std::size_t stage = search_stages_;
  while (stage + 1 < stages_.size() && !stages_[stage].gate && stages_[stage].intervals_x < min_intervals) {
    ++stage;
  }
  return stage;
}

std::size_t Fit::gate_stage() const {
  const auto gate = std::find_if(stages_.begin(), stages_.end(), [](const FitStage& s) { return s.gate; });
  return static_cast<std::size_t>(std::min(gate, stages_.end() - 1) - stages_.begin());
}

std::size_t Fit::stage_of(const FitStart& start) const {
  if (start.entry == FitEntry::few_knots) return search_stages_;
  if (start.entry == FitEntry::own_knots) return first_stage(kKnotsOfStarts);
  return stages_.size() - 1;
}

void Fit::begin_with(const DesignShape& start, std::size_t stage) {
  shape_ = start.refined(stages_[stage].intervals_x, stages_[stage].intervals_y);
  state_.stage = static_cast<int>(stage);
  state_.step = 0;
  state_.refused = 0;
  state_.costs.clear();
  state_.lambda = FitState{}.lambda;
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  state_.intervals_x = shape_.intervals_x();
  state_.intervals_y = shape_.intervals_y();
  ready_ = false;
}

Evaluation Fit::evaluate_at(const DesignShape& shape) {
  EvaluationOptions options;
  options.rays = stage().rays;
  options.direct_light = problem_.direct_light;
  options.rim_mm = kRimShare * shape.aperture().outer_radius_mm();
  return evaluate(shape, problem_.reflectance, *problem_.rays, bins_, options);
}

void Fit::begin_stage(Progress& progress) {
  const FitStage& s = stage();
  problem_.rays->grow(s.rays, progress);
  const bool other = s.intervals_x != shape_.intervals_x() || s.intervals_y != shape_.intervals_y();
  // A stage that is taken up again in its middle has its knots already.
  if (other && state_.step == 0 && (!s.grow || state_.over_noise > kGateFloors)) {
    shape_ = shape_.refined(s.intervals_x, s.intervals_y);
  }
  state_.intervals_x = shape_.intervals_x();
  state_.intervals_y = shape_.intervals_y();
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  bins_ = rebinned(problem_.bins, s.widen, s.bins);
  target_ = problem_.target(bins_);
  scale_.reset();
  if (s.waves > 0.0) scale_.emplace(bins_, s.waves);
  now_ = evaluate_at(shape_);
  equations_ = equations_at(shape_, now_);
  ready_ = true;
}

bool Fit::stalled() const {
  const std::vector<double>& c = state_.costs;
  if (c.size() < 3) return false;
  return std::sqrt(c.back()) > (1.0 - stage().min_gain) * std::sqrt(c[c.size() - 3]);
}

void Fit::finish_stage() {
  const bool gate = stage().gate, search = stage().search;
  const double floor = bin_error(now_, target_, bins_, problem_.mode).floor;
  state_.over_noise = std::sqrt(equations_.cost) / std::max(floor, 1e-12);
  ++state_.stage;
  state_.step = 0;
  state_.refused = 0;
  state_.costs.clear();
  state_.lambda = std::clamp(state_.lambda, 1e-4, 1e-2);
  ready_ = false;
  if (search) {
    if (!stage().search) pass_search();
    return;
  }
  if (gate && !pass_gate()) return;
  if (done()) pass_end(mark());
}

FitMark Fit::mark() const {
  const double missing = 1.0 - now_.flux.sum() / problem_.flux_reference;
  const double less = std::max(0.0, problem_.flux_weight - kFluxWeightOfEnds) * missing * missing;
  return {equations_.cost,    state_.over_noise,  equations_.cost - less,
          state_.intervals_x, state_.intervals_y, state_.parameters};
}

void Fit::take(const FitMark& mark) {
  shape_ = shape_of(mark);
  state_.parameters = mark.parameters;
  state_.intervals_x = mark.intervals_x;
  state_.intervals_y = mark.intervals_y;
}

DesignShape Fit::shape_of(const FitMark& mark) const {
  return family_.refined(mark.intervals_x, mark.intervals_y).with(to_eigen(mark.parameters));
}

bool Fit::pass_gate() {
  const bool better = !state_.gate.exists() || equations_.cost < state_.gate.cost;
  if (better) state_.gate = mark();
  const auto begun = static_cast<std::size_t>(state_.starts);
  if (state_.best.exists()) {
    if (better) return true;
    next_search_restart();
    return false;
  }
  if (state_.gate.over_noise > kGateFloors && begun < std::min(problem_.compared, problem_.starts.size())) {
    ++state_.starts;
    begin_with(problem_.starts[begun].shape, stage_of(problem_.starts[begun]));
    return false;
  }
  if (worth_searching()) {
    if (state_.search_restarts == 0) state_.search_restarts_left = kSearchRestartsAtGate;
    if (state_.search_restarts_left > 0) {
      next_search_restart();
      return false;
    }
  }
  leave_gate();
  return !done();
}

bool Fit::worth_searching() const {
  return search_stages_ > 0 && problem_.max_failed_restarts > 0 && state_.gate.over_noise > kSettledFloors &&
         state_.gate.cost < kNearError * kNearError;
}

void Fit::leave_gate() {
  take(state_.gate);
  state_.stage = static_cast<int>(gate_stage()) + 1;
  state_.step = 0;
  state_.over_noise = state_.gate.over_noise;
  if (done()) pass_end(state_.gate);
}

void Fit::next_search_restart() {
  if (state_.search_restarts_left > 0) {
    --state_.search_restarts_left;
    begin_search_restart();
  } else if (state_.best.exists()) {
    ++state_.failed_restarts;
    restart();
  } else {
    leave_gate();
  }
}

/// First the incumbent, whose cost the others have to beat, and whose twin may be the right one.
void Fit::begin_search_restart() {
  const int number = state_.search_restarts++;
  if (number == 0) {
    begin_with(shape_of(state_.best.exists() ? state_.best : state_.gate), search_stages_ - 1);
    return;
  }
  const auto n = problem_.starts.size();
  begin_with(problem_.starts[static_cast<std::size_t>(number) % n].shape, 0);
  perturb(kSearchPerturbation * problem_.perturbation * shape_.aperture().outer_radius_mm(),
          kSearchStream + static_cast<std::uint64_t>(number));
}

void Fit::pass_search() {
  const bool reference = state_.search_restarts == 1 && !state_.twin;
  if (reference) state_.incumbent_cost = equations_.cost;
  if (!state_.found.exists() || equations_.cost < state_.found.cost) state_.found = mark();
  state_.twin = !state_.twin && equations_.cost < kTwinShare * kTwinShare * state_.incumbent_cost;
  if (state_.twin) {
    begin_with(twin(shape_, point_source(*problem_.rays, kSourceRays).at_mm.z), search_stages_ - 1);
  } else if (state_.found.cost < kSearchGain * kSearchGain * state_.incumbent_cost) {
    state_.incumbent_cost = state_.found.cost;
    begin_with(shape_of(state_.found), gate_stage());
  } else {
    next_search_restart();
  }
}

void Fit::pass_end(const FitMark& now) {
  const bool first = !state_.best.exists();
  const bool gained = first || now.merit < kGain * kGain * state_.best.merit;
  state_.failed_restarts = gained ? 0 : state_.failed_restarts + 1;
  if (first || now.merit < state_.best.merit) state_.best = now;
  restart();
}

/// Another restart, or the end: alternately from the starts and from the incumbent, whose basin may have a
/// better neighbour.
void Fit::restart() {
  if (at_noise() || state_.failed_restarts >= problem_.max_failed_restarts) {
    take(state_.best);
    state_.stage = static_cast<int>(stages_.size());
    return;
  }
  const int number = state_.starts++;
  const std::size_t n = problem_.starts.size();
  if (static_cast<std::size_t>(number) < n) {
    const FitStart& next = problem_.starts[static_cast<std::size_t>(number)];
    begin_with(next.shape, stage_of(next));
    return;
  }
  state_.search_restarts_left = 0;
  if (number % 3 == 2) {
    begin_with(shape_of(state_.best), first_stage(stages_.back().intervals_x));
  } else if (search_stages_ > 0) {
    state_.search_restarts_left = kSearchRestartsLater;
    next_search_restart();
    return;
  } else {
    begin_with(problem_.starts[static_cast<std::size_t>(number) % n].shape, 0);
  }
  perturb(problem_.perturbation * shape_.aperture().outer_radius_mm(), static_cast<std::uint64_t>(number));
}

void Fit::perturb(double size_mm, std::uint64_t stream) {
  shape_ = perturbed(shape_, size_mm, Rng(problem_.seed, stream));
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
}

bool Fit::at_noise() const {
  const double scatter = std::sqrt(2.0 / static_cast<double>(problem_.bins.size()));
  const double over = state_.best.over_noise;
  return state_.best.exists() && over * over <= 1.0 + std::max(kEndShare, 2.0 * scatter);
}

DesignShape Fit::best() const {
  if (state_.best.exists()) return shape_of(state_.best);
  const bool exploring =
      std::any_of(stages_.begin() + state_.stage, stages_.end(), [](const FitStage& s) { return s.gate; });
  return state_.gate.exists() && exploring ? shape_of(state_.gate) : shape_;
}

NormalEquations Fit::equations_at(const DesignShape& shape, const Evaluation& e) const {
  NormalEquations equations =
      scale_ ? normal_equations((*scale_)(e), scale_->flux(target_), bins_, problem_.mode)
             : normal_equations(e, target_, bins_, problem_.mode);
  ResidualRows rows;
  equations.cost += roughness(shape, stage().smoothing, 1.0, &rows);
  if (problem_.limits) equations.cost += problem_.limits(shape, stage().rays, &rows);
  rows.add_to(equations);
  if (problem_.flux_weight > 0.0) {
    add_flux_term(e, problem_.flux_weight, problem_.flux_reference, equations);
  }
  return equations;
}

FitRecord Fit::step(Progress& progress) {
  LUCERNA_CHECK(!done(), "a step after the last stage");
  if (!ready_) {
    begin_stage(progress);
    if (state_.step == 0) {
      ++state_.evaluations;
      state_.total_rays += now_.rays;
      state_.costs = {equations_.cost};
    }
  }
  const Eigen::MatrixXd metric = step_metric(shape_, equations_);
  Eigen::VectorXd move = damped_step(equations_, metric, state_.lambda);
  const double longest = kLongestStep * shape_.aperture().outer_radius_mm();
  while (!(move.cwiseAbs().maxCoeff() <= longest) && state_.lambda < kMaxLambda) {
    state_.lambda *= 4.0;
    move = damped_step(equations_, metric, state_.lambda);
  }
  // Without light there is no step to be had: one that changes nothing is refused.
  if (!(move.cwiseAbs().maxCoeff() <= longest)) move.setZero();
  FitRecord record;
  record.stage = state_.stage;
  record.step = ++state_.step;
  record.lambda = state_.lambda;
  const DesignShape trial = shape_.with(shape_.parameters() + move);
  Evaluation e = evaluate_at(trial);
  ++state_.evaluations;
  state_.total_rays += e.rays;
  NormalEquations equations = equations_at(trial, e);
  record.accepted = equations.cost < equations_.cost;
  if (record.accepted) {
    state_.lambda = next_lambda(state_.lambda, equations_, move, equations.cost);
    shape_ = trial;
    now_ = std::move(e);
    equations_ = std::move(equations);
    state_.costs.push_back(equations_.cost);
  } else {
    state_.lambda *= 5.0;
  }
  state_.refused = record.accepted ? 0 : state_.refused + 1;
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  state_.intervals_x = shape_.intervals_x();
  state_.intervals_y = shape_.intervals_y();
  const BinError error = bin_error(now_, target_, bins_, problem_.mode);
  record.rays = now_.rays;
  record.total_rays = state_.total_rays;
  record.evaluations = state_.evaluations;
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.efficiency = now_.reflected + now_.direct;
  // At the noise of its own rays a stage has nothing left to learn that more rays would not teach better.
  const bool last = state_.stage + 1 == static_cast<int>(stages_.size());
  const bool at_noise = !last && !scale_ && equations_.cost <= error.floor * error.floor;
  if (state_.step >= stage().max_steps || state_.refused >= kMaxRefused || at_noise || stalled()) {
    finish_stage();
  }
  return record;
}

}  // namespace lucerna
