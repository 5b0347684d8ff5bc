// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/free_face_fit.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/cavity_search.h"
#include "lucerna/design/lens/face_search.h"
#include "lucerna/design/lens/outside_weight.h"
#include "lucerna/design/lens/two_face_fit.h"

namespace lucerna {

namespace {

/// A base is judged by faces of so many knots, and rays.
constexpr int kBaseIntervals = 16;
constexpr std::uint64_t kBaseRays = std::uint64_t{1} << 15;
/// That tell where the source is.
constexpr std::uint64_t kBaseSourceRays = std::uint64_t{1} << 12;

/// Domes that a free first face begins as: depths over the radius, how far the last face is over the distance
/// that it has, and how far the rim leaves the axis.
constexpr std::array<double, 5> kDomeDepths{0.0, 0.1, 0.18, 0.27, 0.4};
constexpr std::array<double, 2> kDomeDistances{1.0, 1.25};
constexpr double kDomeDraft_deg = 40.0;

/// How finely two faces are fitted, at most: derivatives are by all rays, for few rays a bin make steps
/// short.
constexpr std::array<FreeFormLevel, 4> kTwoFaceLevels{
    {{.bins = 64, .rays = 1 << 16, .max_steps = 8, .min_gain = 0.03},
     {.bins = 84, .rays = 1 << 18, .max_steps = 12, .min_gain = 0.02},
     {.bins = 108, .rays = 1 << 20, .max_steps = 12, .min_gain = 0.01},
     {.bins = 120, .rays = 1 << 22, .max_steps = 20, .min_gain = 0.005}}};
/// Knots of the first face.
constexpr int kEntryIntervals = 10;

LensProblem with_start(const LensProblem& problem, LensShape start) {
  LensProblem out = problem;
  out.start = std::move(start);
  return out;
}

/// Bases of a lens, judged by the faces that a few steps make over them.
class BaseChoice {
 public:
  BaseChoice(const LensProblem& problem, const LensFitOptions& options, const LensFitWatcher& watch)
      : problem_(problem),
        options_(options),
        watch_(watch),
        flux_reference_(FaceSearch(problem, options).flux_reference()),
        source_(problem.project.scene.sources, problem.world_from_lens.inverse(), options.seed),
        outline_(problem.start) {
    source_.grow(kBaseSourceRays);
  }

  /// Looks at the given base and at cavities in its place.
  void run() {
    static_cast<void>(cost(problem_.start, std::nullopt, 1.0));
    const CavityRange range = cavity_range(problem_.start, problem_.limits);
    if (problem_.free_face->entry == EntryKind::bspline) return look_at_domes(range);
    static_cast<void>(search_cavity(
        range, [&](const CavityTrial& trial) { return judged(trial, 0.0); }, options_.cavity_trials));
  }

  double flux_reference() const { return flux_reference_; }
  const LensShape& outline() const { return outline_; }
  /// Nothing where no base has a face to begin with.
  const std::optional<DesignShape>& face() const { return face_; }
  /// Nothing where the given base is the best.
  const std::optional<Cavity>& cavity() const { return cavity_; }
  int evaluations() const { return evaluations_; }
  std::uint64_t rays() const { return rays_; }
  /// The watcher has ended it.
  bool has_ended() const { return ended_; }

 private:
  /// A spline has no edge, so what becomes one begins as a dome over all of the base, without a steep rim.
  void look_at_domes(const CavityRange& range) {
    for (const double distance : kDomeDistances) {
      for (const double depth : kDomeDepths) {
        const double depth_mm = depth * range.max_radius_mm;
        if (depth_mm <= range.max_depth_mm)
          static_cast<void>(judged({{range.max_radius_mm, depth_mm}, distance}, kDomeDraft_deg));
      }
    }
  }

  /// What a cavity comes to, whose rim leaves the axis by so much at least; nothing where the watcher has
  /// ended it.
  std::optional<double> judged(const CavityTrial& trial, double draft_deg) {
    if (ended_) return std::nullopt;
    try {
      const double least_deg = std::max(draft_deg, problem_.limits.min_draft_deg.value_or(0.0));
      return cost(with_cavity(problem_.start, trial.cavity, least_deg), trial.cavity, trial.distance);
    } catch (const InputError&) {  // no lens
      return std::numeric_limits<double>::infinity();
    }
  }

  double cost(const LensShape& outline, const std::optional<Cavity>& cavity, double distance) {
    if (takes_source_in(outline, problem_.start, source_)) return std::numeric_limits<double>::infinity();
    LensProblem rough = with_start(problem_, outline);
    rough.free_face->intervals = rough.free_face->max_intervals = kBaseIntervals;
    FaceSearch search(rough, {options_.seed, kBaseRays}, flux_reference_, std::nullopt);
    const auto found = search.rough(distance);
    if (!found) return std::numeric_limits<double>::infinity();
    evaluations_ += found->record.evaluations;
    rays_ += found->record.total_rays;
    if (found->cost < least_) {
      least_ = found->cost;
      outline_ = outline;
      cavity_ = cavity;
      face_ = found->face;
    }
    ended_ = !watch_(found->record, {outline_, face_});
    return found->cost;
  }

  const LensProblem& problem_;
  const LensFitOptions& options_;
  const LensFitWatcher& watch_;
  double flux_reference_;
  DesignRays source_;
  double least_ = std::numeric_limits<double>::infinity();
  LensShape outline_;
  std::optional<DesignShape> face_;
  std::optional<Cavity> cavity_;
  int evaluations_ = 0;
  std::uint64_t rays_ = 0;
  bool ended_ = false;
};

void run_search(FaceSearch& face, const LensFitWatcher& watch, LensFitResult& result) {
  FreeFormSearch& search = face.search();
  while (!search.done()) {
    const std::optional<FitRecord> record = search.step();
    if (!record) continue;
    result.history.push_back(*record);
    if (watch(*record, face.best())) continue;
    result.end = DesignTermination::time;
    break;
  }
  result.lens = face.held();
  result.evaluations += search.state().evaluations;
  result.rays += search.state().total_rays;
}

/// The entry becomes a free form, and goes on from what it is.
void fit_two_faces(const LensProblem& problem, const LensFitOptions& options, const BaseChoice& base,
                   FaceSearch& face, const LensFitWatcher& watch, LensFitResult& result) {
  std::vector<FreeFormLevel> levels;
  for (const FreeFormLevel& with : kTwoFaceLevels) {
    levels.push_back(with);
    levels.back().rays = std::min(with.rays, options.max_rays);
    levels.back().smoothing = face.search().level(0).smoothing;
  }
  ShapedLens begin = face.best();
  const bool has_own_knots = problem.free_face->intervals == problem.free_face->max_intervals;
  if (base.face() && !has_own_knots) begin.face = base.face();
  begin.entry =
      entry_of(begin.outline, problem.limits, std::min(kEntryIntervals, problem.free_face->intervals));
  result.cavity.reset();
  TwoFaceFit(problem, options.seed, std::move(begin), std::move(levels), face.flux_reference())
      .run(watch, result);
}

LensFitResult fit_face_and_entry(const LensProblem& problem, const LensFitOptions& options,
                                 const LensFitWatcher& watch) {
  BaseChoice base(problem, options, watch);
  base.run();
  FaceSearch face(with_start(problem, base.outline()), options, base.flux_reference(), base.face());
  LensFitResult result(face.best());
  result.cavity = base.cavity();
  result.evaluations = base.evaluations();
  result.rays = base.rays();
  if (!base.has_ended() && problem.free_face->entry == EntryKind::bspline) {
    fit_two_faces(problem, options, base, face, watch, result);
  } else if (!base.has_ended()) {
    run_search(face, watch, result);
  } else {
    result.end = DesignTermination::time;
    result.lens = face.held();
  }
  return result;
}

}  // namespace

LensFitResult fit_free_face(const LensProblem& given, const LensFitOptions& options,
                            const LensFitWatcher& watch) {
  LensProblem problem = given;
  problem.free_face->outside_weight = outside_weight(problem.target);
  if (problem.free_face->entry != EntryKind::given) return fit_face_and_entry(problem, options, watch);
  FaceSearch face(problem, options);
  LensFitResult result(face.best());
  run_search(face, watch, result);
  return result;
}

}  // namespace lucerna
