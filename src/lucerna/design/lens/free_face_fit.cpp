// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/free_face_fit.h"

#include <limits>
#include <optional>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/cavity_search.h"
#include "lucerna/design/lens/face_search.h"

namespace lucerna {

namespace {

/// A base is judged by faces of so many knots, and rays.
constexpr int kBaseIntervals = 16;
constexpr std::uint64_t kBaseRays = std::uint64_t{1} << 15;
/// That tell where the source is.
constexpr std::uint64_t kBaseSourceRays = std::uint64_t{1} << 12;

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
    const auto judged = [&](const CavityTrial& trial) -> std::optional<double> {
      if (ended_) return std::nullopt;
      try {
        const double draft_deg = problem_.limits.min_draft_deg.value_or(0.0);
        return cost(with_cavity(problem_.start, trial.cavity, draft_deg), trial.cavity, trial.distance);
      } catch (const InputError&) {  // no lens
        return std::numeric_limits<double>::infinity();
      }
    };
    static_cast<void>(search_cavity(range, judged, options_.cavity_trials));
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

LensFitResult fit_face_and_entry(const LensProblem& problem, const LensFitOptions& options,
                                 const LensFitWatcher& watch) {
  BaseChoice base(problem, options, watch);
  base.run();
  FaceSearch face(with_start(problem, base.outline()), options, base.flux_reference(), base.face());
  LensFitResult result(face.best());
  result.cavity = base.cavity();
  result.evaluations = base.evaluations();
  result.rays = base.rays();
  if (!base.has_ended()) {
    run_search(face, watch, result);
  } else {
    result.end = DesignTermination::time;
    result.lens = face.held();
  }
  return result;
}

}  // namespace

LensFitResult fit_free_face(const LensProblem& problem, const LensFitOptions& options,
                            const LensFitWatcher& watch) {
  if (problem.free_face->shapes_entry) return fit_face_and_entry(problem, options, watch);
  FaceSearch face(problem, options);
  LensFitResult result(face.best());
  run_search(face, watch, result);
  return result;
}

}  // namespace lucerna
