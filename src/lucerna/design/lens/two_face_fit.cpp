// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/two_face_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/design/lens/entry_face.h"
#include "lucerna/design/lens/other_light.h"

namespace lucerna {

namespace {

/// Steps of a face before the other has its turn, and turns in a row that gain little.
constexpr int kStepsOfTurn = 3, kLittleTurns = 2;
/// Of the rays whose light is fitted, those whose other ways are followed.
constexpr std::uint64_t kFewerOther = 8;
/// Least damping: with less, knots that little light tells of fit its noise.
constexpr double kLeastLambda = 1e-5;
/// Noise of the derivatives over the rest, at most; the share of noise that is believed, at most; and bins of
/// a level, at least. Noise goes with the bins, and where it is large it damps every step. A source that is
/// small beside the lens needs fine bins and has little noise; what a wide one blurs is seen in coarse ones.
constexpr double kMaxNoise = 0.6, kMostNoise = 0.75;
constexpr int kFewestBins = 28;
constexpr std::uint64_t kLookRays = std::uint64_t{1} << 15;
/// That tell where the source is.
constexpr std::uint64_t kEndRays = std::uint64_t{1} << 14;

void count(std::uint64_t rays, LensFitResult& result) {
  ++result.evaluations;
  result.rays += rays;
}

Frame world_from_design(const LensProblem& problem) { return problem.world_from_lens * lens_from_design(); }

std::unique_ptr<DesignRays> rays_of(const LensProblem& problem, std::uint64_t seed) {
  return std::make_unique<DesignRays>(problem.project.scene.sources, world_from_design(problem).inverse(),
                                      seed);
}

}  // namespace

TwoFaceFit::TwoFaceFit(const LensProblem& problem, std::uint64_t seed, ShapedLens begin,
                       std::vector<FreeFormLevel> levels, double flux_reference)
    : problem_(problem),
      seed_(seed),
      lens_(std::move(begin)),
      levels_(std::move(levels)),
      flux_reference_(flux_reference) {
  entry_.is_entry = true;
  entry_.rays = rays_of(problem_, seed_);
  entry_.rays->grow(kEndRays);
  source_end_ = source_end(*entry_.rays);
  lens_.entry = limits_of(entry_, kFitRings).held_nearby(*lens_.entry).value_or(*lens_.entry);
}

double TwoFaceFit::prepare(Side& side, std::uint64_t count) {
  if (side.is_entry) {
    side.rays->refract_in(problem_.medium, *lens_.face);
    side.rays->grow(count);
    return 1.0;
  }
  // Drawn anew: by another first face they come in otherwise.
  side.rays = rays_of(problem_, seed_);
  side.rays->refract(problem_.medium, into_entry(*lens_.entry, problem_.medium));
  side.rays->grow(count);
  return side.rays->share_left(count);
}

ShapeLimits TwoFaceFit::limits_of(const Side& side, int rings) const {
  if (side.is_entry)
    return entry_limits(problem_.limits, lens_.outline, *lens_.entry, *lens_.face, source_end_, rings);
  return face_limits(problem_.limits, seat_of(lens_), *lens_.face, rings);
}

FitProblem TwoFaceFit::fit_problem(const Side& side, double within,
                                   std::shared_ptr<const ShapeLimits> limits) const {
  const DesignTarget& target = problem_.target;
  const Frame frame = world_from_design(problem_);
  FitProblem fit{side.rays.get(), Reflectance(1.0), target_flux(target, frame, side.rays->flux() * within),
                 target_bins(target, frame, false), target.mode};
  fit.seed = seed_;
  fit.direct_light = false;
  fit.outside_weight = problem_.free_face->outside_weight;
  if (target.mode == TargetMode::shape) {
    fit.flux_weight = problem_.light_weight;
    fit.flux_reference = flux_reference_ / within;
  }
  fit.limits = [limits](const DesignShape& shape, std::uint64_t, ResidualRows* rows) {
    return limits->cost(shape, rows);
  };
  fit.form = std::move(limits);
  fit.other_light = [this, within](const DesignShape&, const TentBins&, std::uint64_t) -> Eigen::VectorXd {
    return other_light_ / within;
  };
  fit.rectangle = target_rectangle(target);
  fit.mirror_from_world = frame.inverse();
  return fit;
}

FitRecord TwoFaceFit::measured(const FreeFormFit& fit, const FreeFormPoint& point, double within) {
  const BinError error = fit.error(point);
  FitRecord record;
  record.rays = point.light.rays;
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.efficiency = within * point.light.reflected;
  record.in_rectangle = within * fit.in_rectangle(point);
  return record;
}

FreeFormLevel TwoFaceFit::level_of(int number) const {
  FreeFormLevel out = levels_[static_cast<std::size_t>(number)];
  const double bins = std::sqrt(kMaxNoise * static_cast<double>(out.rays) / noise_);
  out.bins = std::clamp(static_cast<int>(std::min(bins, 1e6)), kFewestBins, std::max(kFewestBins, out.bins));
  return out;
}

void TwoFaceFit::note_noise(const FreeFormLevel& level, const FreeFormPoint& point) {
  const double share = std::clamp(point.equations.derivative_noise, 1e-9, kMostNoise);
  noise_ = share / (1.0 - share) * static_cast<double>(level.rays) / (level.bins * level.bins);
}

void TwoFaceFit::look_at_noise(LensFitResult& result) {
  FreeFormLevel l = levels_.front();
  l.bins = kFewestBins;
  const double within = prepare(last_, l.rays);
  const FitProblem problem =
      fit_problem(last_, within, std::make_shared<const ShapeLimits>(limits_of(last_, kFitRings)));
  note_noise(l, FreeFormFit(problem, l).at(*lens_.face));
  count(l.rays, result);
}

bool TwoFaceFit::turn(Side& side, int number, const FreeFormLevel& l, const LensFitWatcher& watch,
                      LensFitResult& result) {
  const double within = prepare(side, l.rays);
  const FitProblem problem =
      fit_problem(side, within, std::make_shared<const ShapeLimits>(limits_of(side, kFitRings)));
  FreeFormFit fit(problem, l);
  if (other_light_.size() == 0)
    other_light_ = other_light(problem_, lens_, fit.bins(), l.rays / kFewerOther, seed_);
  // The same for both faces, though each looks at it by its own shape.
  fit.keep_other_light_of(shape(side));
  FreeFormPoint point = fit.at(shape(side));
  note_noise(l, point);
  count(l.rays, result);
  bool was_refused = false;
  for (int k = 0; k < kStepsOfTurn; ++k) {
    const bool accepted = fit.step(point, side.lambda, was_refused);
    side.lambda = std::max(side.lambda, kLeastLambda);
    was_refused = !accepted;
    count(l.rays, result);
    shape(side) = point.shape;
    side.cost = point.equations.cost;
    FitRecord record = measured(fit, point, within);
    record.evaluations = result.evaluations;
    record.total_rays = result.rays;
    record.stage = number;
    record.step = static_cast<int>(result.history.size());
    record.lambda = side.lambda;
    record.accepted = accepted;
    record.candidate = side.is_entry ? 1 : 0;
    result.history.push_back(record);
    if (watch(record, lens_)) continue;
    result.end = DesignTermination::time;
    return false;
  }
  return true;
}

std::optional<double> TwoFaceFit::look(int turns, const LensFitWatcher& watch, LensFitResult& result) {
  FreeFormLevel l = levels_.front();
  l.rays = std::min(l.rays, kLookRays);
  l.bins = kFewestBins;
  other_light_.resize(0);
  for (int k = 0; k < turns; ++k) {
    if (!turn(last_, 0, l, watch, result) || !turn(entry_, 0, l, watch, result)) return std::nullopt;
  }
  return entry_.cost - std::pow(result.history.back().floor, 2);
}

bool TwoFaceFit::run_level(int number, const LensFitWatcher& watch, LensFitResult& result) {
  const FreeFormLevel l = level_of(number);
  other_light_.resize(0);
  double before = std::numeric_limits<double>::infinity();
  int little = 0;
  for (int turns = 0; turns < l.max_steps && little < kLittleTurns; ++turns) {
    if (!turn(last_, number, l, watch, result) || !turn(entry_, number, l, watch, result)) return false;
    little = std::sqrt(entry_.cost) > (1.0 - l.min_gain) * std::sqrt(before) ? little + 1 : 0;
    before = entry_.cost;
  }
  return true;
}

ShapedLens TwoFaceFit::held() const {
  ShapedLens out = lens_;
  out.entry = limits_of(entry_, kCheckRings).held_nearby(*lens_.entry).value_or(*lens_.entry);
  const ShapeLimits last = face_limits(problem_.limits, seat_of(out), *lens_.face, kCheckRings);
  out.face = last.held_nearby(*lens_.face).value_or(*lens_.face);
  return out;
}

void TwoFaceFit::run(const LensFitWatcher& watch, LensFitResult& result) {
  look_at_noise(result);
  for (int level = 0; level < static_cast<int>(levels_.size()); ++level) {
    if (!run_level(level, watch, result)) break;
  }
  result.lens = held();
}

}  // namespace lucerna
