// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/base_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/face_search.h"

namespace lucerna {

namespace {

/// A base is judged by faces of so many knots, and rays.
constexpr int kBaseIntervals = 16;
constexpr std::uint64_t kBaseRays = std::uint64_t{1} << 15;
/// That tell where the source is.
constexpr std::uint64_t kBaseSourceRays = std::uint64_t{1} << 12;

/// A spline has no edge: what becomes one begins as a cavity whose rim leaves the axis by so much.
constexpr double kDomeDraft_deg = 40.0;

/// Bases whose cavities differ by less, of the larger's radius, are much alike.
constexpr double kAlike = 0.3;

bool are_alike(const LensBase& a, const LensBase& b) {
  const Cavity one = a.cavity.value_or(Cavity{}), other = b.cavity.value_or(Cavity{});
  return std::hypot(one.radius_mm - other.radius_mm, one.depth_mm - other.depth_mm) <=
         kAlike * std::max(one.radius_mm, other.radius_mm);
}

}  // namespace

LensProblem with_start(const LensProblem& problem, LensShape start) {
  LensProblem out = problem;
  out.start = std::move(start);
  return out;
}

BaseChoice::BaseChoice(const LensProblem& problem, const LensFitOptions& options, const LensFitWatcher& watch)
    : problem_(problem),
      options_(options),
      watch_(watch),
      flux_reference_(FaceSearch(problem, options).flux_reference()),
      source_(problem.project.scene.sources, problem.world_from_lens.inverse(), options.seed),
      bases_{{problem.start, std::nullopt, std::nullopt}} {
  source_.grow(kBaseSourceRays);
}

void BaseChoice::run() {
  static_cast<void>(cost({problem_.start, std::nullopt, std::nullopt}, 1.0));
  const double draft_deg = problem_.free_face->entry == EntryKind::bspline ? kDomeDraft_deg : 0.0;
  static_cast<void>(search_cavity(
      cavity_range(problem_.start, problem_.limits),
      [&](const CavityTrial& trial) { return judged(trial, draft_deg); }, options_.cavity_trials));
}

std::vector<LensBase> BaseChoice::distinct(std::size_t count) const {
  std::vector<LensBase> out;
  for (const LensBase& base : bases_) {
    if (out.size() < count && (base.face || out.empty()) &&
        std::none_of(out.begin(), out.end(), [&](const LensBase& b) { return are_alike(base, b); }))
      out.push_back(base);
  }
  return out;
}

/// What a cavity comes to, whose rim leaves the axis by so much at least; nothing where the watcher has ended
/// the search.
std::optional<double> BaseChoice::judged(const CavityTrial& trial, double draft_deg) {
  if (ended_) return std::nullopt;
  try {
    const double least_deg = std::max(draft_deg, problem_.limits.min_draft_deg.value_or(0.0));
    return cost({with_cavity(problem_.start, trial.cavity, least_deg), std::nullopt, trial.cavity},
                trial.distance);
  } catch (const InputError&) {  // no lens
    return std::numeric_limits<double>::infinity();
  }
}

double BaseChoice::cost(LensBase base, double distance) {
  if (takes_source_in(base.outline, problem_.start, source_)) return std::numeric_limits<double>::infinity();
  LensProblem rough = with_start(problem_, base.outline);
  rough.free_face->intervals = rough.free_face->max_intervals = kBaseIntervals;
  FaceSearch search(rough, {options_.seed, kBaseRays}, flux_reference_, std::nullopt);
  const auto found = search.rough(distance);
  if (!found) return std::numeric_limits<double>::infinity();
  evaluations_ += found->record.evaluations;
  rays_ += found->record.total_rays;
  base.face = found->face;
  base.cost = found->cost;
  const auto after = std::upper_bound(bases_.begin(), bases_.end(), base.cost,
                                      [](double cost, const LensBase& b) { return cost < b.cost; });
  bases_.insert(after, std::move(base));
  FitRecord record = found->record;
  record.evaluations = evaluations_;
  record.total_rays = rays_;
  ended_ = !watch_(record, {best().outline, best().face});
  return found->cost;
}

}  // namespace lucerna
