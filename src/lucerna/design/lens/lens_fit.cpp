// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/lens/cumulative_flux.h"
#include "lucerna/design/lens/lens_evaluation.h"
#include "lucerna/design/lens/lens_smoothness.h"
#include "lucerna/design/lens/lens_start.h"
#include "lucerna/design/lens/lens_tailoring.h"
#include "lucerna/design/solver/levenberg_marquardt.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Longest way of a corner in one step, over the lens's radius.
constexpr double kLongestCornerMove = 0.01;
/// Size of the waves that make another start, and of those that perturb the best, over the radius.
constexpr double kOtherStart = 0.03, kPerturbation = 0.004;
/// Starts of the coarse stages; how many of them the next one takes on, and how much more squared error than
/// the best's they may have; and how often the best is perturbed before the fine stages.
constexpr int kStarts = 8, kTakenOn = 3, kEarlyRestarts = 4;
constexpr double kHopeful = 9.0;
/// Of the lenses tailored to a point source those that are started from, and the rays that make the point.
constexpr std::size_t kTailored = 5;
constexpr std::uint64_t kPointRays = std::uint64_t{1} << 15;
/// A start that costs no more than so many times the squared noise needs no other beside it.
constexpr double kEnough = 3.0;
/// A start is given up where a stage leaves so much more squared error than with the best.
constexpr double kFarBehind = 100.0;
/// A stage ends after two steps that gained less than this share each, or so many refused in a row.
constexpr double kLittleGain = 0.02, kLittleCoarseGain = 0.05;
constexpr int kMostRefused = 8, kMostSteps = 40, kMostCoarseSteps = 20;
/// The last stages have so many times the rings, this many at most: boxes of the error cut a caustic in all
/// places, and see what is finer than they are.
constexpr int kFinerRings = 4, kMostFineRings = 2048;
/// Weight of roughness (`lens_roughness`): a wave of 3 % of the radius with three half periods counts as an
/// error of 0.16 %.
constexpr double kRoughnessWeight = 8e-9;
/// What of the source may be within the lens beyond what the given one holds.
constexpr double kMaxWithin = 1e-3;
constexpr std::uint64_t kWithinRays = 4096;
/// The fit ends where the squared error is no more than so many times that of noise.
constexpr double kNoiseAtEnd = 1.21;
/// Light is not round where boxes see so much more error than rings, by so many rays. Light whose shape is
/// farther off than this is cut otherwise by boxes, round or not.
constexpr double kNotRound = 0.02, kShaped = 0.1;
constexpr std::uint64_t kRoundRays = std::uint64_t{1} << 18;
constexpr int kBoxes = 48;
/// Cumulative light is left out of fine stages where it costs so many times the squared error.
constexpr double kOutOfReach = 30.0;
/// A restart goes on to more rays only if this much of the best's squared error is left.
constexpr double kBetter = 0.97;

/// What the squared error in bins weighs in a stage, light within each ring (`add_cumulative_flux`), and lost
/// light, this over the problem's `light_weight`.
struct StageWeights {
  double bins = 1.0, cumulative = 0.0, light = 1.0;
};
/// In the first stage of rings cumulative light leads. It counts later too: a caustic that is a ring off is
/// no nearer to its place by the rings alone. In coarse stages lost light weighs as much beside it as in the
/// first, else many starts end with the right shape of less light; in fine ones an exact shape is what is
/// wanted.
constexpr StageWeights kFirstWeights{0.01, 100.0, 2.0}, kCoarseWeights{1.0, 3000.0, 60.0},
    kFineWeights{1.0, 3000.0};

struct LensStage {
  int bins;
  std::uint64_t rays;
  StageWeights weights;
  /// Many starts go through it.
  bool is_coarse = false;
  /// Its bins are those of a square, though the target's are rings.
  bool in_boxes = false;
};

struct LensPoint {
  LensShape shape;
  Evaluation light;
  NormalEquations equations;
};

/// The target in the bins of stages.
struct BinnedTarget {
  TentBins bins;
  Eigen::VectorXd flux;
};

/// The problem in the bins and rays of one stage.
class LensStageObjective {
 public:
  LensStageObjective(const LensProblem& problem, const LensStage& stage, const BinnedTarget& target,
                     DesignRays& rays, const std::vector<double>& signs, double flux_reference,
                     double given_within)
      : problem_(problem),
        rays_(rays),
        signs_(signs),
        bins_(target.bins),
        target_(target.flux),
        flux_reference_(flux_reference),
        given_within_(given_within),
        weights_(stage.weights),
        roughness_(kRoughnessWeight * lens_roughness(problem.start)) {
    rays.grow(stage.rays);
    options_.rays = stage.rays;
    options_.edge_mm = kEdgeShare * problem.start.radius_mm();
  }

  LensPoint at(const LensShape& shape) const {
    LensPoint out{shape, {}, {}};
    out.equations.cost = std::numeric_limits<double>::infinity();
    if (!shape.is_valid()) return out;
    if (share_within(shape, rays_, kWithinRays) > given_within_ + kMaxWithin) return out;
    out.light = evaluate_lens(shape, problem_.medium, rays_, bins_, options_);
    out.equations = equations(out.light);
    const Eigen::VectorXd rough = roughness_ * shape.parameters();
    out.equations.cost += shape.parameters().dot(rough);
    out.equations.gradient += rough;
    out.equations.hessian += roughness_;
    ResidualRows rows;
    out.equations.cost += lens_limits_cost(problem_.limits, shape, signs_, rows);
    rows.add_to(out.equations);
    if (problem_.target.mode == TargetMode::shape)
      add_missing_light(out.light, light_weight(), flux_reference_, out.equations);
    return out;
  }

  /// What light beside the window costs.
  double light_cost(const Evaluation& light) const {
    const double missing = missing_light(light.flux.sum(), flux_reference_);
    return problem_.target.mode == TargetMode::shape ? light_weight() * missing * missing : 0.0;
  }
  /// The squared error and what lost light costs, without derivatives: in a fraction of the time.
  double look(const LensShape& shape) const {
    if (share_within(shape, rays_, kWithinRays) > given_within_ + kMaxWithin)
      return std::numeric_limits<double>::infinity();
    const Evaluation light = light_of(shape);
    const double off = error(light).relative_rms;
    return off * off + light_cost(light);
  }
  /// The squared error, less that of noise.
  double squared_excess(const LensShape& shape) const {
    const BinError found = error(light_of(shape));
    return std::max(0.0, found.relative_rms * found.relative_rms - found.floor * found.floor);
  }

  BinError error(const Evaluation& light) const {
    return bin_error(light, target_, bins_, problem_.target.mode);
  }
  std::uint64_t rays() const { return options_.rays; }

 private:
  double light_weight() const { return weights_.light * problem_.light_weight; }

  Evaluation light_of(const LensShape& shape) const {
    LensEvaluationOptions plain = options_;
    plain.derivatives = false;
    return evaluate_lens(shape, problem_.medium, rays_, bins_, plain);
  }

  NormalEquations equations(const Evaluation& light) const {
    NormalEquations out = normal_equations(light, target_, bins_, problem_.target.mode);
    out.cost *= weights_.bins;
    out.gradient *= weights_.bins;
    out.hessian *= weights_.bins;
    if (weights_.cumulative > 0.0)
      add_cumulative_flux(light, target_, problem_.target.mode, weights_.cumulative, out);
    return out;
  }

  const LensProblem& problem_;
  DesignRays& rays_;
  const std::vector<double>& signs_;
  const TentBins& bins_;
  const Eigen::VectorXd& target_;
  double flux_reference_, given_within_;
  StageWeights weights_;
  Eigen::MatrixXd roughness_;
  LensEvaluationOptions options_;
};

/// All of a fit between its steps.
class LensFit {
 public:
  LensFit(const LensProblem& problem, const LensFitOptions& options, DesignRays& rays,
          const LensFitWatcher& watch)
      : problem_(problem),
        options_(options),
        rays_(rays),
        watch_(watch),
        signs_(draft_signs(problem.start)),
        tilt_(lens_tilt(problem.start)),
        window_(lens_window(problem)),
        result_({problem.start}) {
    rays_.grow(std::uint64_t{1} << 16);
    given_within_ = share_within(problem.start, rays_, kWithinRays);
    LensEvaluationOptions plain;
    plain.derivatives = false;
    const Evaluation start = evaluate_lens(problem.start, problem.medium, rays_, window_, plain);
    flux_reference_ = start.reflected + start.direct;
    if (window_.is_rings()) flux_reference_ *= target_share_within(problem, window_.extent());
    stages_ = stages_of(window_, static_cast<int>(problem.start.parameter_count()), options.max_rays);
    const auto coarse =
        std::count_if(stages_.begin(), stages_.end(), [](const auto& s) { return s.is_coarse; });
    coarse_ = static_cast<std::size_t>(coarse);
    // A cap on the rays can make the last stages one.
    const auto same = [](const LensStage& a, const LensStage& b) {
      return a.rays == b.rays && a.bins == b.bins;
    };
    while (stages_.size() > coarse_ + 2 && same(stages_.back(), stages_[stages_.size() - 2]))
      stages_.pop_back();
    waiting_ = starts();
  }

  LensFitResult run() {
    std::vector<Candidate> begun;
    const auto ended = [&] { return stopped_ || (!begun.empty() && begun.back().is_enough); };
    while (!waiting_.empty() && !ended()) begun.push_back(coarsely(next_start(), 0));
    for (int k = 0; k < kEarlyRestarts && !ended(); ++k) {
      sort_by_cost(begun);
      begun.push_back(coarsely(perturbed(begun.front().shape, k), coarse_ - 1));
    }
    sort_by_cost(begun);
    if (is_not_round(begun.front().shape)) {
      go_on_in_boxes();
    } else if (begun.front().out_of_reach) {
      for (std::size_t s = coarse_; s < stages_.size(); ++s) stages_[s].weights.cumulative = 0.0;
    }
    result_.lens.outline = begun.front().shape;
    coarse_cost_ = begun.front().cost;
    for (std::size_t k = 0; k < std::min<std::size_t>(kTakenOn, begun.size()); ++k) {
      if (begun[k].cost <= kHopeful * coarse_cost_) take_on(begun[k].shape);
    }
    finish();
    for (int failed = 0, k = 0; !stopped_ && !result_.at_noise; ++k) {
      if (failed >= problem_.max_failed_restarts) break;
      failed = restart(k) ? 0 : failed + 1;
    }
    return std::move(result_);
  }

 private:
  struct Candidate {
    double cost;
    LensShape shape;
    /// Needs no other beside it.
    bool is_enough = false;
    /// What it costs is light many rings off, as of a beam that is narrower than the source allows: fine
    /// stages would weigh that alone.
    bool out_of_reach = false;
  };

  /// How far a stage came.
  struct StageEnd {
    double cost = std::numeric_limits<double>::infinity();
    double squared_error = cost, squared_noise = 0.0, light_cost = 0.0;
  };

  /// Coarse ones, one of middling size at which restarts are compared, and fine ones.
  static std::vector<LensStage> stages_of(const TentBins& window, int parameters, std::uint64_t max_rays) {
    const auto rays = [&](int log2) { return std::min(max_rays, std::uint64_t{1} << log2); };
    if (!window.is_rings())
      return {
          {24, rays(15), {}, true}, {kBoxes, rays(17), {}}, {kBoxes, rays(20), {}}, {kBoxes, rays(22), {}}};
    const int least = parameters + 6;
    const int rings = std::max(window.count(), least), coarse = std::max(window.count() / 3, least);
    const int finest = std::min(kFinerRings * rings, std::max(rings, kMostFineRings));
    return {{coarse, rays(14), kFirstWeights, true}, {coarse, rays(14), kCoarseWeights, true},
            {rings, rays(14), kCoarseWeights, true}, {std::min(2 * rings, finest), rays(16), kFineWeights},
            {finest, rays(18), kFineWeights},        {finest, rays(20), kFineWeights}};
  }

  /// The given lens, those of a point source, and the given one perturbed.
  std::deque<LensShape> starts() {
    std::deque<LensShape> out{problem_.start};
    const PointSource source = point_source(rays_, kPointRays);
    const PrescribedAngle angle(target_flux(problem_.target, problem_.world_from_lens, 1.0));
    for (LensShape& s : zero_etendue_lenses(problem_.start, problem_.medium, source, angle))
      out.push_back(std::move(s));
    if (out.size() == 1) {
      for (LensShape& s : best_tailored(source, angle)) out.push_back(std::move(s));
    }
    for (int k = 0; static_cast<int>(out.size()) < kStarts; ++k) out.push_back(other_start(k));
    return out;
  }
  /// Of the lenses that are tailored to a point source those that do best with the source as it is.
  std::vector<LensShape> best_tailored(const PointSource& source, const PrescribedAngle& angle) {
    const auto all = tailored_lenses(problem_.start, problem_.medium, source, angle, problem_.limits);
    std::vector<Candidate> looked_at;
    for (const LensShape& shape : all) looked_at.push_back({objective_of(coarse_ - 1).look(shape), shape});
    sort_by_cost(looked_at);
    std::vector<LensShape> out;
    for (std::size_t k = 0; k < std::min<std::size_t>(kTailored, looked_at.size()); ++k)
      out.push_back(std::move(looked_at[k].shape));
    return out;
  }
  LensShape other_start(int k) const {
    return perturbed_smoothly(problem_.start, kOtherStart * problem_.start.radius_mm(),
                              Rng(options_.seed ^ 0x4C454E53ull, static_cast<std::uint64_t>(k)));
  }
  /// Of those that have not begun.
  LensShape next_start() {
    LensShape shape = std::move(waiting_.front());
    waiting_.pop_front();
    return shape;
  }

  /// Takes a shape through the middling stage; keeps it where it is the best there.
  bool take_on(LensShape shape) {
    if (stopped_) return false;
    const double cost = through(shape, coarse_, coarse_ + 1).cost;
    if (!(cost < middle_cost_)) return false;
    const bool gained = cost < kBetter * middle_cost_;
    middle_cost_ = cost;
    middle_ = std::move(shape);
    if (!std::isfinite(fine_cost_)) result_.lens.outline = *middle_;
    return gained;
  }

  /// The fine stages from the best of the middling one; keeps what comes of it where it is the best.
  bool finish() {
    if (stopped_ || !middle_) return false;
    LensShape shape = *middle_;
    const StageEnd end = through(shape, coarse_ + 1, stages_.size());
    if (!(end.cost < fine_cost_)) return false;
    const bool gained = end.cost < kBetter * fine_cost_;
    fine_cost_ = end.cost;
    result_.lens.outline = std::move(shape);
    result_.at_noise = end.squared_error <= kNoiseAtEnd * end.squared_noise;
    return gained;
  }

  /// Two times of three from the best, a little perturbed; else from another start.
  bool restart(int k) {
    const Candidate found = k % 3 == 2
                                ? coarsely(waiting_.empty() ? other_start(kStarts + k) : next_start(), 0)
                                : coarsely(perturbed(result_.lens.outline, kEarlyRestarts + k), coarse_ - 1);
    if (stopped_ || !(found.cost <= kHopeful * coarse_cost_)) return false;
    coarse_cost_ = std::min(found.cost, coarse_cost_);
    return take_on(found.shape) && finish();
  }

  /// A shape after the coarse stages from `stage` on; given up where it stays far behind the best.
  Candidate coarsely(LensShape shape, std::size_t stage) {
    StageEnd end;
    best_of_stage_.resize(coarse_, end.cost);
    for (; stage < coarse_ && !stopped_; ++stage) {
      end = through(shape, stage, stage + 1);
      best_of_stage_[stage] = std::min(end.cost, best_of_stage_[stage]);
      if (!(end.cost <= kFarBehind * best_of_stage_[stage])) break;
    }
    if (stage < coarse_) end = {};
    const double rings_off = end.cost - end.squared_error - end.light_cost;
    return {end.cost, std::move(shape), end.cost <= kEnough * end.squared_noise,
            rings_off > kOutOfReach * end.squared_error};
  }

  static void sort_by_cost(std::vector<Candidate>& all) {
    std::stable_sort(all.begin(), all.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  }

  /// Every third time by more.
  LensShape perturbed(const LensShape& shape, int k) const {
    const double size = kPerturbation * problem_.start.radius_mm() * (k % 3 == 2 ? 3.0 : 1.0);
    return perturbed_smoothly(shape, size, Rng(options_.seed ^ 0x4B49434Bull, static_cast<std::uint64_t>(k)));
  }

  /// Takes `shape` through stages; returns the end of the last.
  StageEnd through(LensShape& shape, std::size_t first, std::size_t last) {
    StageEnd end;
    for (std::size_t s = first; s < last && !stopped_; ++s) {
      const LensStageObjective& objective = objective_of(s);
      LensPoint now = objective.at(shape);
      count(objective, now, static_cast<int>(s), 0, 0.0, true);
      if (!std::isfinite(now.equations.cost)) return {};
      steps(objective, now, static_cast<int>(s));
      shape = now.shape;
      const BinError error = objective.error(now.light);
      end = {now.equations.cost, error.relative_rms * error.relative_rms, error.floor * error.floor,
             objective.light_cost(now.light)};
    }
    return end;
  }

  const LensStageObjective& objective_of(std::size_t stage) {
    objectives_.resize(stages_.size());
    if (objectives_[stage] == nullptr)
      objectives_[stage] = std::make_unique<LensStageObjective>(made(stages_[stage]));
    return *objectives_[stage];
  }
  LensStageObjective made(const LensStage& stage) {
    return {problem_, stage, binned(stage), rays_, signs_, flux_reference_, given_within_};
  }

  /// Whether light that turns with the target in rings does not in boxes: a source that is not round leaves
  /// its image in a beam, of which rings see the mean.
  bool is_not_round(const LensShape& shape) {
    // Squares do not see behind the lens.
    if (!window_.is_rings() || window_.extent() > 0.5 * std::numbers::pi || stopped_) return false;
    const std::uint64_t rays = std::min(options_.max_rays, kRoundRays);
    const double in_rings = made({window_.count(), rays, {}}).squared_excess(shape);
    if (in_rings > kShaped * kShaped) return false;
    boxes_ = lens_boxes(problem_);
    const double in_boxes = made({kBoxes, rays, {}, false, true}).squared_excess(shape);
    return in_boxes > in_rings + kNotRound * kNotRound;
  }

  /// The stages after the coarse ones see the light in boxes from now on.
  void go_on_in_boxes() {
    stages_.resize(coarse_);
    for (const LensStage& stage : stages_of(*boxes_, 0, options_.max_rays)) {
      if (stage.is_coarse) continue;
      stages_.push_back(stage);
      stages_.back().in_boxes = true;
    }
  }

  /// Made when it is first asked for: a target in bins takes as long as an evaluation.
  const BinnedTarget& binned(const LensStage& stage) {
    const std::pair<int, bool> key{stage.bins, stage.in_boxes};
    const auto found = targets_.find(key);
    if (found != targets_.end()) return found->second;
    TentBins bins = rebinned(stage.in_boxes ? *boxes_ : window_, 1.0, stage.bins);
    Eigen::VectorXd flux = target_flux(problem_.target, problem_.world_from_lens, rays_.flux())(bins);
    return targets_.emplace(key, BinnedTarget{std::move(bins), std::move(flux)}).first->second;
  }

  void steps(const LensStageObjective& objective, LensPoint& now, int stage) {
    double lambda = 1e-3;
    const double longest = kLongestCornerMove * problem_.start.radius_mm();
    const bool coarse = stages_[static_cast<std::size_t>(stage)].is_coarse;
    const int most = coarse ? kMostCoarseSteps : kMostSteps;
    const double little = coarse ? kLittleCoarseGain : kLittleGain;
    for (int step = 1, small = 0, refused = 0; step <= most && !stopped_; ++step) {
      const double before = now.equations.cost;
      const Eigen::VectorXd diagonal = now.equations.hessian.diagonal();
      // As of free-form mirrors: smooth changes may be long while corners do not go zigzag.
      Eigen::MatrixXd metric = (kTiltShare * diagonal.mean()) * tilt_;
      metric.diagonal() += own_share(diagonal);
      const Eigen::VectorXd from = now.shape.parameters();
      const LevenbergMarquardtStep made = levenberg_marquardt_step(
          now, [&](double damping) { return damped_step(now.equations, metric, damping); }, lambda, longest,
          [&](const Eigen::VectorXd& move) { return objective.at(problem_.start.with(from + move)); });
      lambda = made.next_lambda;
      count(objective, now, stage, step, made.tried_lambda, made.accepted);
      refused = made.accepted ? 0 : refused + 1;
      if (refused >= kMostRefused || lambda >= kMaxLambda) return;
      if (!made.accepted) continue;
      small = before - now.equations.cost < little * before ? small + 1 : 0;
      if (small == 2) return;
    }
  }

  void count(const LensStageObjective& objective, const LensPoint& now, int stage, int step, double lambda,
             bool accepted) {
    ++result_.evaluations;
    result_.rays += objective.rays();
    FitRecord r;
    r.stage = stage;
    r.step = step;
    r.rays = objective.rays();
    r.total_rays = result_.rays;
    r.evaluations = result_.evaluations;
    r.lambda = lambda;
    r.accepted = accepted;
    if (std::isfinite(now.equations.cost)) {
      const BinError error = objective.error(now.light);
      r.error = error.relative_rms;
      r.floor = error.floor;
      r.efficiency = now.light.reflected + now.light.direct;
    }
    result_.history.push_back(r);
    if (!watch_(r, {std::isfinite(fine_cost_) ? result_.lens.outline : now.shape})) {
      stopped_ = true;
      result_.end = DesignTermination::time;
    }
  }

  const LensProblem& problem_;
  LensFitOptions options_;
  DesignRays& rays_;
  const LensFitWatcher& watch_;
  std::vector<double> signs_;
  Eigen::MatrixXd tilt_;
  TentBins window_;
  /// Made when rings have to be compared with them.
  std::optional<TentBins> boxes_;
  std::map<std::pair<int, bool>, BinnedTarget> targets_;
  std::vector<LensStage> stages_;
  std::vector<std::unique_ptr<LensStageObjective>> objectives_;
  double flux_reference_ = 1.0, given_within_ = 0.0;
  /// How many of the stages are coarse; the next is the middling one.
  std::size_t coarse_ = 0;
  /// Starts that have not begun.
  std::deque<LensShape> waiting_;
  std::vector<double> best_of_stage_;
  double coarse_cost_ = std::numeric_limits<double>::infinity();
  double middle_cost_ = coarse_cost_, fine_cost_ = coarse_cost_;
  std::optional<LensShape> middle_;
  bool stopped_ = false;
  LensFitResult result_;
};

}  // namespace

LensFitResult fit_lens(const LensProblem& problem, const LensFitOptions& options, DesignRays& rays,
                       const LensFitWatcher& watch) {
  return LensFit(problem, options, rays, watch).run();
}

}  // namespace lucerna
