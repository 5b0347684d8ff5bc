// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/free_form_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/peers.h"
#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/fit/approach.h"
#include "lucerna/design/initial/initial_guesses.h"
#include "lucerna/design/search/free_form_levels.h"
#include "lucerna/design/search/mode_search.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Knots of the rough level, at most.
constexpr int kRoughIntervals = 32;
/// A trough's few parameters are known from fewer rays.
constexpr std::uint64_t kFewerRaysOfTroughs = 4;
/// An approach that came no nearer than this has too few knots for the target.
constexpr double kFewKnotsError = 0.03;
/// Farthest neighbour of the best: its vertex distance is within this factor.
constexpr double kFarthest = 1.3;
/// After so many steps of a level what an approach costs is compared with what the best had.
constexpr int kEarlySteps = 5;
/// Steps of the last level for an approach that others are to follow: in little time it is the result.
constexpr int kTrialSteps = 5;
/// Steps in a row, each five times as damped as the one before, after which a level is at its end.
constexpr int kMaxRefusedInARow = 5;
/// The squared error at the end is the noise's and this share more.
constexpr double kNoiseShare = 0.1;
/// A mirror that fits its own rays below their noise still costs so much of what it did.
constexpr double kMinCostShare = 0.02;
/// Least damping: with less, knots that little light tells of fit its noise.
constexpr double kMinLambda = 1e-5;
/// A lens's face is near a source that is wide beside the knots of finer levels. Steps there are short, and
/// gain little after such as were refused: a level ends where twice as many steps as elsewhere gain so much
/// less.
constexpr double kFaceGain = 0.6;
constexpr std::size_t kSteps = 2, kFaceSteps = 4;
/// Weight of roughness where slopes are measured in half widths of the target's rectangle: where the light is
/// blurred by the source's size a rough surface costs no light. At a three-hundredth of it slopes jump by a
/// degree from knot to knot, at the same error.
constexpr double kSmoothing = 0.03;
/// Random streams of perturbed starts of approaches begin here.
constexpr std::uint64_t kApproachStream = std::uint64_t{1} << 34;
/// That tell where the source is.
constexpr std::uint64_t kUnitRays = std::uint64_t{1} << 14;
constexpr double kStartWiden = 1.1;

/// Intervals along both sides where the longer has `max`.
std::pair<int, int> intervals_of(const Aperture& a, int max) {
  const double x = a.half_x_mm(), y = a.half_y_mm(), longer = std::max(x, y);
  return {std::max(4, static_cast<int>(std::lround(max * x / longer))),
          std::max(4, static_cast<int>(std::lround(max * y / longer)))};
}

/// What the first candidates' vertex distances are told in: a mirror's radius, half a trough's width, a lens
/// face's own distance.
double distance_unit_mm(const FitProblem& problem, const DesignShape& given) {
  if (!problem.rays->medium()) return given.radius_mm();
  problem.rays->grow(kUnitRays);
  return point_source(*problem.rays, kUnitRays).at_mm.z - given.at(0.0, 0.0).z_mm;
}

}  // namespace

std::optional<DesignShape> free_form_guess(const FitProblem& problem, const DesignShape& family,
                                           const TransportChoice& choice, const StartLight& light) {
  if (family.is_trough()) return trough_guess(problem, family, choice);
  problem.rays->grow(light.rays);
  const TentBins bins = graded_bins(problem.rectangle, problem.mirror_from_world, light.bins, kStartWiden, 0);
  return transport_guess({problem.rays, light.rays, problem.reflectance.max(), problem.direct_light,
                          problem.target(bins), bins, light.cells, light.rounds},
                         family, choice);
}

FreeFormSearch::FreeFormSearch(const FitProblem& problem, const DesignShape& given, int max_intervals,
                               std::uint64_t max_rays, FreeFormState state)
    : problem_(problem),
      given_(given),
      max_intervals_(std::max({max_intervals, given.intervals_x(), given.intervals_y()})),
      max_rays_(max_rays),
      unit_mm_(distance_unit_mm(problem, given)),
      rules_{has_few_knots(given), max_intervals_ == std::max(given.intervals_x(), given.intervals_y()),
             problem.rays->medium().has_value(), problem.start_is_chosen, problem.max_failed_restarts},
      state_(std::move(state)) {}

FreeFormLevel FreeFormSearch::level(int number) const {
  FreeFormLevel out = free_form_level(number);
  const double half = 0.5 * std::max(problem_.rectangle.width(), problem_.rectangle.height());
  const int max = number == 0 ? std::min(kRoughIntervals, max_intervals_) : max_intervals_;
  if (given_.is_trough()) {
    out.intervals_x = max;
    out.intervals_y = given_.intervals_y();
    out.rays /= kFewerRaysOfTroughs;
  } else {
    std::tie(out.intervals_x, out.intervals_y) = intervals_of(given_.aperture(), max);
  }
  out.rays = std::min(out.rays, max_rays_);
  out.smoothing = problem_.rectangle.is_plane ? kSmoothing : kSmoothing / (half * half);
  if (const auto& medium = problem_.rays->medium()) {
    // A mirror turns light by twice what it turns itself, a face by less: slopes of that much more are
    // smooth.
    const double turn = 0.5 * (medium->index - 1.0);
    out.smoothing *= turn * turn;
    if (number > 0) out.min_gain *= kFaceGain;
  }
  out.zones = zone_stage(number);
  return out;
}

TransportChoice FreeFormSearch::first_choice(int number) const {
  if (number >= kFirstApproach && number < kAfterApproaches) return {};
  const FirstChoices& first = first_choices(problem_.rays->medium().has_value(), given_.is_trough());
  const TransportChoice c = number < kFirstApproach
                                ? first.before[static_cast<std::size_t>(number - 1)]
                                : first.after[static_cast<std::size_t>(number - kAfterApproaches)];
  return {c.sign, c.vertex_distance_mm * unit_mm_};
}

TransportChoice FreeFormSearch::choice(int number) const {
  if (number < kFirstNeighbour) return first_choice(number);
  // A neighbour of the best; of the first choice where the given mirror is the best.
  Rng rng(problem_.seed, static_cast<std::uint64_t>(number), 77);
  const FreeFormSnapshot* best = order().best_of(kEndLevel);
  const bool of_given = best != nullptr && !best->transport.exists();
  if (of_given && (rules_.has_fixed_few_knots() || CandidateOrder::is_approach(*best))) return {};
  const TransportChoice about = best != nullptr && !of_given ? best->transport : first_choice(1);
  const double factor = std::pow(kFarthest, 2.0 * rng.uniform() - 1.0);
  return {about.sign, factor * about.vertex_distance_mm};
}

std::optional<DesignShape> FreeFormSearch::start_of(const FreeFormSnapshot& snapshot) {
  if (snapshot.candidate == 0) return nearer_of_given();
  if (!snapshot.transport.exists()) return approached(snapshot.candidate - kFirstApproach);
  const FreeFormLevel rough = level(0);
  const DesignShape family = given_.refined(rough.intervals_x, rough.intervals_y);
  const std::optional<DesignShape> guess = free_form_guess(problem_, family, snapshot.transport);
  return guess && problem_.within ? problem_.within(*guess) : guess;
}

InitialGuess FreeFormSearch::start_of_approach(int restart) {
  if (restart == 0) return {given_};
  const auto number = static_cast<std::uint64_t>(restart);
  const bool has_modes = !given_.is_trough() && !problem_.rays->medium();
  if (!has_modes || restart % 2 == 0) {
    const double size_mm = problem_.perturbation * given_.radius_mm();
    return {perturbed(given_, size_mm, Rng(problem_.seed, kApproachStream + number))};
  }
  return {paid_for(mode_search(problem_, given_, problem_.seed + number)), InitialKnots::own_knots};
}

DesignShape FreeFormSearch::approached(int restart) {
  return paid_for(approach(problem_, start_of_approach(restart), max_rays_));
}

DesignShape FreeFormSearch::paid_for(FoundShape found) {
  state_.evaluations += found.evaluations;
  state_.total_rays += found.rays;
  return std::move(found.shape);
}

DesignShape FreeFormSearch::nearer_of_given() {
  if (!rules_.has_fixed_few_knots() || problem_.rays->medium()) return given_;
  DesignShape near = approached(0);
  const FreeFormFit fit(problem_, level(0));
  state_.evaluations += 2;
  state_.total_rays += 2 * level(0).rays;
  return fit.at(near).equations.cost < fit.at(given_).equations.cost ? near : given_;
}

DesignShape FreeFormSearch::shape_of(const FreeFormSnapshot& snapshot) const {
  return given_.refined(snapshot.intervals_x, snapshot.intervals_y)
      .with(Eigen::VectorXd::Map(snapshot.parameters.data(),
                                 static_cast<Eigen::Index>(snapshot.parameters.size())));
}

FreeFormLevel FreeFormSearch::level_after(const FreeFormSnapshot& before, int number,
                                          const DesignShape& shape) const {
  FreeFormLevel l = level(number);
  l.derivative_rays = l.rays;
  if (number == 0) return l;
  // Noise goes with the number of pairs of a bin and a cell of knots that the rays are dealt to.
  const double bins = static_cast<double>(l.bins) / before.bins;
  const double cells = static_cast<double>(shape.intervals_x() * shape.intervals_y()) /
                       (before.intervals_x * before.intervals_y);
  const double rays = static_cast<double>(l.rays) / static_cast<double>(level(number - 1).rays);
  const double noise = before.derivative_noise * bins * bins * cells / rays;
  return for_noise(l, noise);
}

void FreeFormSearch::evaluate_at(const DesignShape& shape, std::uint64_t rays) {
  point_.emplace(fit_->at(shape));
  ++state_.evaluations;
  state_.total_rays += rays;
}

bool FreeFormSearch::has_too_few_knots(const FreeFormSnapshot& approach) const {
  if (approach.level != 0 || !CandidateOrder::is_approach(approach) || !order().may_approach()) return false;
  const BinError error = fit_->error(*point_);
  return error.relative_rms > std::hypot(error.floor, kFewKnotsError);
}

void FreeFormSearch::begin(const DesignShape& shape, const FreeFormSnapshot& snapshot, Progress& progress) {
  // Knots are refined, never coarsened, and only where something is left to gain.
  const FreeFormLevel with = level(snapshot.level);
  const int nx = std::max(shape.intervals_x(), with.intervals_x);
  const int ny = std::max(shape.intervals_y(), with.intervals_y);
  const bool has = shape.intervals_x() == nx && shape.intervals_y() == ny;
  const bool own = has || order().knots_suffice(snapshot);
  const DesignShape first = own ? shape : shape.refined(nx, ny);
  const FreeFormLevel l = level_after(snapshot, snapshot.level, first);
  fit_.emplace(problem_, l, progress);
  fit_->keep_other_light_of(first);
  evaluate_at(first, l.rays);
  // On the rough level, which is the same for any knots.
  if (own && !has && has_too_few_knots(snapshot)) evaluate_at(shape.refined(nx, ny), l.rays);
  state_.now = snapshot;
  state_.now.early_cost = 0.0;
  state_.now.bins = l.bins;
  state_.now.derivative_rays = l.derivative_rays;
  state_.now.intervals_x = point_->shape.intervals_x();
  state_.now.intervals_y = point_->shape.intervals_y();
  state_.step = 0;
  state_.refused = 0;
  state_.lambda = std::clamp(state_.lambda, 1e-4, 1.0);
  state_.costs = {point_->equations.cost};
}

void FreeFormSearch::choose(Progress& progress) {
  if (const FreeFormSnapshot* snapshot = order().next_promotion()) {
    FreeFormSnapshot next = *snapshot;
    ++next.level;
    begin(shape_of(next), next, progress);
    return;
  }
  state_.begun = order().next_number(state_.begun);
  const FreeFormSnapshot next = candidate(state_.begun);
  if (looks_ahead()) {
    if (!is_among(ahead_, next)) fit_ahead();
    replay_.emplace(taken_from(ahead_, next), state_);
  }
  ++state_.begun;
  if (!replay_) return begin_candidate(next, progress);
  state_.failed = replay_->has_start() ? 0 : state_.failed + 1;
  if (!replay_->has_start()) replay_.reset();
}

void FreeFormSearch::begin_candidate(const FreeFormSnapshot& candidate, Progress& progress) {
  const std::optional<DesignShape> start = start_of(candidate);
  state_.failed = start ? 0 : state_.failed + 1;
  if (!start) return;
  state_.lambda = FreeFormState{}.lambda;
  begin(*start, candidate, progress);
}

FreeFormSnapshot FreeFormSearch::candidate(int number) const {
  FreeFormSnapshot out;
  out.candidate = number;
  out.level = 0;
  if (number > 0) out.transport = choice(number);
  return out;
}

std::vector<FreeFormSnapshot> FreeFormSearch::upcoming(std::size_t max) const {
  // Neighbours are those of a mirror that is fitted to the end; whether an approach is worth its time shows
  // when it is next.
  const int neighbours = order().best_of(kEndLevel) == nullptr ? 0 : rules_.max_neighbours;
  const int end = kFirstNeighbour + neighbours;
  std::vector<FreeFormSnapshot> out{candidate(state_.begun)};
  for (int n = state_.begun + 1; n < end && out.size() < max; ++n) {
    n = state_.begun < kFirstApproach && n == kFirstApproach ? kAfterApproaches : order().next_number(n);
    const FreeFormSnapshot next = candidate(n);
    if (!is_among(ahead_, next)) out.push_back(next);
  }
  return out;
}

bool FreeFormSearch::looks_ahead() const {
  const Peers* peers = problem_.rays->peers();
  return peers != nullptr && peers->size() > 1;
}

void FreeFormSearch::fit_ahead() {
  Peers* const peers = problem_.rays->peers();
  const std::vector<FreeFormSnapshot> next = upcoming(static_cast<std::size_t>(peers->size()));
  // Each has one of them at most, as the rays may grow for it.
  const UnsharedRays unshared(*problem_.rays);
  const auto key = StateKey().add(static_cast<std::uint64_t>(state_.begun)).add(state_.total_rays).value();
  const std::vector<std::string> fits =
      dealt_items(peers, next.size(), key, [&](std::size_t i) { return message_of(rough_fit(next[i])); });
  for (const std::string& fit : fits) ahead_.push_back(rough_fit_of(fit));
}

RoughFit FreeFormSearch::rough_fit(const FreeFormSnapshot& candidate) const {
  RoughFit out{candidate.candidate, candidate.transport, {}};
  FreeFormSearch alone(problem_, given_, max_intervals_, max_rays_);
  alone.begin_candidate(candidate, no_progress());
  if (!alone.point_) return out;
  out.steps.push_back({alone.measured(true), alone.state_});
  while (!alone.level_ended()) {
    const bool accepted = alone.advance(no_progress());
    out.steps.push_back({alone.measured(accepted), alone.state_});
  }
  return out;
}

FitRecord FreeFormSearch::replayed() {
  const RoughStep step = replay_->next();
  FreeFormState now = step.state;
  now.begun = state_.begun;
  now.failed = state_.failed;
  now.done = std::move(state_.done);
  state_ = std::move(now);
  return step.record;
}

bool FreeFormSearch::level_ended() const {
  const FreeFormLevel l = level(state_.now.level);
  const bool is_trial = state_.now.level == kEndLevel && CandidateOrder::is_approach(state_.now) &&
                        order().others_are_to_be_approached();
  if (is_trial && state_.step >= kTrialSteps) return true;
  if (state_.step >= l.max_steps || state_.refused >= kMaxRefusedInARow) return true;
  const std::vector<double>& c = state_.costs;
  if (order().is_hopeless(state_.now, c.size() - 1) || order().is_slow_approach()) return true;
  const std::size_t steps = problem_.rays->medium() && state_.now.level > 0 ? kFaceSteps : kSteps;
  return c.size() > steps && std::sqrt(c.back()) > (1.0 - l.min_gain) * std::sqrt(c[c.size() - 1 - steps]);
}

void FreeFormSearch::forget_what_cannot_win() {
  for (FreeFormSnapshot& m : state_.done) {
    if (order().is_over(m)) m.parameters.clear();
  }
}

void FreeFormSearch::finish() {
  state_.done.push_back(std::move(state_.now));
  state_.now = {};
  fit_.reset();
  point_.reset();
  replay_.reset();
  forget_what_cannot_win();
}

std::optional<FitRecord> FreeFormSearch::step(Progress& progress) {
  const bool begins = !state_.now.exists();
  if (begins) choose(progress);
  if (begins && !replay_ && !point_) return std::nullopt;
  const FitRecord record = replay_ ? replayed() : measured(begins || advance(progress));
  if (level_ended()) finish();
  return record;
}

bool FreeFormSearch::advance(Progress& progress) {
  if (!point_) {  // taken up again in the middle of a level
    FreeFormLevel l = with_bins(level(state_.now.level), state_.now.bins);
    l.derivative_rays = state_.now.derivative_rays;
    fit_.emplace(problem_, l, progress);
    fit_->keep_other_light_of(shape_of(state_.now));
    point_.emplace(fit_->at(shape_of(state_.now)));
  }
  const bool accepted = fit_->step(*point_, state_.lambda, state_.refused > 0);
  state_.lambda = std::max(state_.lambda, kMinLambda);
  ++state_.evaluations;
  ++state_.step;
  state_.total_rays += level(state_.now.level).rays;
  state_.refused = accepted ? 0 : state_.refused + 1;
  if (accepted) state_.costs.push_back(point_->equations.cost);
  return accepted;
}

FitRecord FreeFormSearch::measured(bool accepted) {
  const BinError error = fit_->error(*point_);
  const Eigen::VectorXd& p = point_->shape.parameters();
  state_.now.parameters.assign(p.begin(), p.end());
  const double of_noise = point_->equations.derivative_noise;
  const double derived =
      static_cast<double>(state_.now.derivative_rays) / static_cast<double>(level(state_.now.level).rays);
  state_.now.derivative_noise = derived * of_noise / std::max(1.0 - of_noise, 1e-3);
  const double cost = point_->equations.cost, weight = fit_->error_weight();
  const double squared = error.relative_rms * error.relative_rms, noise = error.floor * error.floor;
  const double excess = std::max(squared - noise, kMinCostShare * squared);
  state_.now.error = std::sqrt(excess);
  state_.now.cost = error_share(state_.now.level) * weight * excess + (cost - weight * squared);
  state_.now.error_to_noise = std::sqrt(cost / std::max(weight * noise, 1e-24));
  if (state_.step == kEarlySteps) state_.now.early_cost = state_.now.cost;
  FitRecord record;
  record.accepted = accepted;
  record.stage = state_.now.level;
  record.step = state_.step;
  record.candidate = state_.now.candidate;
  record.rays = point_->light.rays;
  record.total_rays = state_.total_rays;
  record.evaluations = state_.evaluations;
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.lambda = state_.lambda;
  record.efficiency = point_->light.reflected + point_->light.direct;
  record.in_rectangle = fit_->in_rectangle(*point_);
  return record;
}

bool FreeFormSearch::out_of_candidates() const { return order().is_out_of_candidates(); }

bool FreeFormSearch::done() const {
  if (order().is_at_end()) return true;
  const FreeFormSnapshot* best = order().best_of(kMoreRaysLevel);
  return best != nullptr && best->error_to_noise * best->error_to_noise <= 1.0 + kNoiseShare;
}

std::uint64_t FreeFormSearch::next_rays() const {
  if (replay_) return 0;
  if (state_.now.exists()) return (point_ ? 1 : 2) * level(state_.now.level).rays;
  const FreeFormSnapshot* next = order().next_promotion();
  if (next == nullptr && looks_ahead()) {
    const bool fitted = is_among(ahead_, candidate(order().next_number(state_.begun)));
    return fitted ? 0 : static_cast<std::uint64_t>(level(0).max_steps + 1) * level(0).rays;
  }
  return 2 * level(next != nullptr ? next->level + 1 : 0).rays;
}

DesignShape FreeFormSearch::best() const {
  const FreeFormSnapshot* best = nullptr;
  const auto better = [&](const FreeFormSnapshot& m) {
    return !m.parameters.empty() &&
           (best == nullptr || m.level > best->level || (m.level == best->level && m.cost < best->cost));
  };
  for (const FreeFormSnapshot& m : state_.done) {
    if (better(m)) best = &m;
  }
  // The one at work only gets better; where it has come so far, it counts.
  if (state_.now.exists() && !state_.now.parameters.empty() &&
      (best == nullptr || best->candidate == state_.now.candidate || better(state_.now))) {
    best = &state_.now;
  }
  return best != nullptr ? shape_of(*best) : given_;
}

}  // namespace lucerna
