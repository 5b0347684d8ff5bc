// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/free_face_fit.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lucerna/design/lens/base_choice.h"
#include "lucerna/design/lens/face_search.h"
#include "lucerna/design/lens/outside_weight.h"
#include "lucerna/design/lens/two_face_fit.h"

namespace lucerna {

namespace {

/// How finely two faces are fitted, at most: derivatives are by all rays, for few rays a bin make steps
/// short.
constexpr std::array<FreeFormLevel, 4> kTwoFaceLevels{
    {{.bins = 64, .rays = 1 << 16, .max_steps = 8, .min_gain = 0.03},
     {.bins = 84, .rays = 1 << 18, .max_steps = 12, .min_gain = 0.02},
     {.bins = 108, .rays = 1 << 20, .max_steps = 12, .min_gain = 0.01},
     {.bins = 120, .rays = 1 << 22, .max_steps = 20, .min_gain = 0.005}}};
/// Knots of the first face.
constexpr int kEntryIntervals = 10;
/// Bases that are compared with both faces free, and turns of both faces before the worse half is dropped.
constexpr std::size_t kTwoFaceStarts = 3;
constexpr int kTurnsOfLook = 2;

void run_search(FaceSearch& face, const LensFitWatcher& watch, LensFitResult& result) {
  FreeFormSearch& search = face.search();
  while (!search.done()) {
    std::optional<FitRecord> record = search.step();
    if (!record) continue;
    // After those of the choice of a base.
    record->evaluations += result.evaluations;
    record->total_rays += result.rays;
    result.history.push_back(*record);
    if (watch(*record, face.best())) continue;
    result.end = DesignTermination::time;
    break;
  }
  result.lens = face.held();
  result.evaluations += search.state().evaluations;
  result.rays += search.state().total_rays;
}

std::vector<FreeFormLevel> two_face_levels(const LensFitOptions& options, double smoothing) {
  std::vector<FreeFormLevel> out;
  for (const FreeFormLevel& with : kTwoFaceLevels) {
    out.push_back(with);
    out.back().rays = std::min(with.rays, options.max_rays);
    out.back().smoothing = smoothing;
  }
  return out;
}

/// The entries of several bases become free forms, and the best of these goes on.
class TwoFaceStarts {
 public:
  TwoFaceStarts(const LensProblem& problem, const LensFitOptions& options, const BaseChoice& choice)
      : problem_(problem), options_(options), choice_(choice) {}

  void run(const LensFitWatcher& watch, LensFitResult& result) {
    for (const LensBase& base : choice_.distinct(kTwoFaceStarts)) add(base);
    while (fits_.size() > 1) {
      for (Start& start : fits_) {
        const std::optional<double> cost = start.fit->look(kTurnsOfLook, watch, result);
        if (!cost) return best_so_far(result);
        start.cost = *cost;
      }
      sort();
      fits_.resize((fits_.size() + 1) / 2);
    }
    fits_.front().fit->run(watch, result);
  }

 private:
  struct Start {
    std::unique_ptr<TwoFaceFit> fit;
    double cost = std::numeric_limits<double>::infinity();
  };

  void sort() {
    std::stable_sort(fits_.begin(), fits_.end(),
                     [](const Start& a, const Start& b) { return a.cost < b.cost; });
  }

  void best_so_far(LensFitResult& result) {
    sort();
    result.lens = fits_.front().fit->held();
  }

  void add(const LensBase& base) {
    FaceSearch face(with_start(problem_, base.outline), options_, choice_.flux_reference(), base.face);
    ShapedLens begin = face.best();
    const bool has_own_knots = problem_.free_face->intervals == problem_.free_face->max_intervals;
    if (base.face && !has_own_knots) begin.face = base.face;
    begin.entry =
        entry_of(begin.outline, problem_.limits, std::min(kEntryIntervals, problem_.free_face->intervals));
    fits_.push_back({std::make_unique<TwoFaceFit>(problem_, options_.seed, std::move(begin),
                                                  two_face_levels(options_, face.search().level(0).smoothing),
                                                  choice_.flux_reference())});
  }

  const LensProblem& problem_;
  const LensFitOptions& options_;
  const BaseChoice& choice_;
  std::vector<Start> fits_;
};

LensFitResult fit_face_and_entry(const LensProblem& problem, const LensFitOptions& options,
                                 const LensFitWatcher& watch) {
  BaseChoice choice(problem, options, watch);
  choice.run();
  const LensBase& base = choice.best();
  LensFitResult result({base.outline});
  result.evaluations = choice.evaluations();
  result.rays = choice.rays();
  if (!choice.has_ended() && problem.free_face->entry == EntryKind::bspline) {
    TwoFaceStarts(problem, options, choice).run(watch, result);
    return result;
  }
  FaceSearch face(with_start(problem, base.outline), options, choice.flux_reference(), base.face);
  result.cavity = base.cavity;
  if (!choice.has_ended()) {
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
