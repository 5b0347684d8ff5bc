// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/statistics/surface_guess.h"
#include "lucerna/source/adaptive/charts/chart_batch.h"
#include "lucerna/source/adaptive/search/support_moves.h"
#include "lucerna/source/adaptive/search/support_polish.h"
#include "lucerna/source/adaptive/search/support_score.h"

namespace lucerna {

namespace {

constexpr std::size_t kScreenRays = 9000, kCoarseRays = 24000, kFineRays = 60000, kPolishRays = 120000;
/// Candidates that are refined, and of them those of one kind.
constexpr std::size_t kRefined = 5, kRefinedOfKind = 2;
/// How many of them are still refined after each round.
constexpr std::array<std::size_t, 6> kRacers{4, 3, 2, 2, 1, 1};
constexpr int kFineRounds = 3;

/// What the candidates are made from.
struct RayShape {
  Vec3 focus_mm, mean_direction;
  /// The centre of the bounding surface if it is round, and the focus.
  std::vector<Vec3> centres_mm;
  std::vector<Direction> axes;
  double spread_mm = 0.0;  // RMS distance of the lines from the focus
};

double quantile(std::vector<double> v, double share) {
  if (v.empty()) return 0.0;
  const auto at = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

void add_axis(std::vector<Direction>& axes, const Vec3& v) {
  if (!(length(v) > 1e-9)) return;
  const Direction d = Direction::from(v);
  for (const Direction& known : axes) {
    if (std::abs(dot(known.vec(), d.vec())) > 0.99995) return;
  }
  axes.push_back(d);
}

RayShape shape_of(const RayBlock& rays, const RaySummary& summary, const BoundingSurface& surface) {
  RayShape shape;
  shape.focus_mm = summary.virtual_focus ? summary.virtual_focus->point_mm : Vec3{};
  if (surface.kind == SurfaceKind::sphere || surface.kind == SurfaceKind::cylinder) {
    shape.centres_mm.push_back(surface.world_from_surface.origin_mm());
  }
  shape.centres_mm.push_back(shape.focus_mm);
  shape.mean_direction = summary.mean_direction.value_or(Vec3{});
  Eigen::Matrix3d p2 = Eigen::Matrix3d::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray r = rays.ray(i);
    const Vec3 o = r.origin_mm - shape.focus_mm, p = o - dot(o, r.direction.vec()) * r.direction.vec();
    const double w = static_cast<double>(rays.weight[i]);
    const Eigen::Vector3d v(p.x, p.y, p.z);
    p2 += w * v * v.transpose();
    weight += w;
  }
  shape.spread_mm = std::sqrt(p2.trace() / weight);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(p2);
  if (length(shape.mean_direction) > 0.1) add_axis(shape.axes, shape.mean_direction);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d v = solver.eigenvectors().col(k);
    add_axis(shape.axes, {v.x(), v.y(), v.z()});
  }
  for (const Vec3& v : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) add_axis(shape.axes, v);
  return shape;
}

/// +z along `axis`; +x as near to the world's x (or y) as can be, so that upright sets keep their axes.
Frame upright_frame(const Direction& axis, const Vec3& origin_mm) {
  const Vec3 seed = std::abs(axis.x()) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Direction x = Direction::from(seed - dot(seed, axis.vec()) * axis.vec());
  return {x.vec(), cross(axis.vec(), x.vec()), axis.vec(), origin_mm};
}

/// Radius and half length about the focus and along `axis` that hold nearly all of the light.
std::array<double, 2> cylinder_size(const RayBlock& rays, const Frame& frame) {
  Support probe;
  probe.kind = SupportKind::axis;
  probe.world_from_support = frame;
  std::vector<double> along, across;
  RayBatch batch;
  ChartBatch lines;
  for (std::size_t first = 0; first < rays.size(); first += kSupportBatch) {
    const std::size_t n = std::min(kSupportBatch, rays.size() - first);
    load_batch(rays, first, 1, n, batch);
    charts_of(probe, batch, lines);
    for (std::size_t i = 0; i < n; ++i) {
      if (lines.chart[i] == kNoChart) continue;
      along.push_back(std::abs(lines.c[0][i]));
      across.push_back(std::abs(lines.c[1][i]));
    }
  }
  return {quantile(std::move(across), 0.985), quantile(std::move(along), 0.97)};
}

void add_round(std::vector<Support>& all, const RayBlock& rays, const Direction& axis,
               const Vec3& centre_mm) {
  const Frame frame = upright_frame(axis, centre_mm);
  Support s;
  s.world_from_support = frame;
  s.kind = SupportKind::axis;
  all.push_back(s);
  for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
    s.kind = SupportKind::focal;
    s.map = map;
    all.push_back(s);
  }
  const auto [radius, half] = cylinder_size(rays, frame);
  if (!(radius > 0.0 && half > 0.0)) return;
  for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
    s.map = map;
    s.kind = SupportKind::cylinder;
    s.radius_mm = 1.01 * radius;
    s.half_size_mm = {s.radius_mm, s.radius_mm, 1.05 * half};
    all.push_back(s);
    s.kind = SupportKind::sphere;
    s.half_size_mm = {};
    s.radius_mm = 1.02 * std::max(radius, half);
    all.push_back(s);
  }
}

/// Flat sources seen through balls of glass of several sizes: LEDs under a dome.
void add_domes(std::vector<Support>& all, const RayBlock& rays, const RayShape& shape) {
  constexpr double kIndex = 1.5, kNearlyAll = 0.998;
  for (const Vec3& centre : shape.centres_mm) {
    std::vector<double> offset;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 o = rays.origin_mm(i) - centre;
      offset.push_back(length(cross(o, rays.direction(i).vec())));
    }
    const double min = quantile(std::move(offset), kNearlyAll);
    if (!(min > 0.0)) continue;
    for (const Direction& axis : shape.axes) {
      for (const double size : {1.1, 1.5, 2.2, 3.5}) {
        for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
          Support s;
          s.kind = SupportKind::plane;
          s.map = map;
          s.world_from_support = upright_frame(axis, centre);
          s.dome = {centre, size * min, kIndex};
          all.push_back(s);
        }
      }
    }
  }
}

std::vector<Support> candidates(const RayBlock& rays, const RayShape& shape, const BoundingSurface& surface) {
  std::vector<Support> all;
  for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
    if (const auto given = support_on(surface, map)) all.push_back(*given);
    for (const Direction& axis : shape.axes) {
      Support s;
      s.kind = SupportKind::plane;
      s.map = map;
      s.world_from_support = upright_frame(axis, shape.focus_mm);
      all.push_back(s);
      s.kind = SupportKind::disk;
      all.push_back(s);
    }
  }
  for (const Vec3& centre : shape.centres_mm) {
    for (const Direction& axis : shape.axes) add_round(all, rays, axis, centre);
  }
  add_domes(all, rays, shape);
  return all;
}

/// One round of compass search: the best of all single steps is taken while one gains.
SupportScore refine_round(const HeldOutScorer& scorer, SupportScore start, double length_mm, double angle,
                          Progress& progress) {
  constexpr int kMaxSteps = 5;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (progress.stop_requested()) throw Interrupted();
    std::vector<Support> trials;
    for (int move = 0; move < kSupportMoves; ++move) {
      for (const double sign : {-1.0, 1.0}) {
        if (const auto t = moved(start.on.support, move, sign * length_mm, sign * angle))
          trials.push_back(*t);
      }
    }
    const auto scores = scorer.scores(trials);
    const auto best = std::max_element(scores.begin(), scores.end(),
                                       [](const auto& a, const auto& b) { return a.nats < b.nats; });
    if (best == scores.end() || !scorer.clearly_better(*best, start)) break;
    start = *best;
  }
  return scorer.tightened(start);
}

/// Rounds with steps halved after each.
SupportScore refine(const HeldOutScorer& scorer, SupportScore start, double length_mm, double angle,
                    int rounds, Progress& progress) {
  for (int round = 0; round < rounds; ++round, length_mm *= 0.5, angle *= 0.5) {
    start = refine_round(scorer, std::move(start), length_mm, angle, progress);
  }
  return start;
}

std::vector<SupportScore> best_first(std::vector<SupportScore> scores) {
  std::stable_sort(scores.begin(), scores.end(),
                   [](const auto& a, const auto& b) { return a.nats > b.nats; });
  return scores;
}

/// Rays through a point, parallel to one another, or through a line: the support in which most numbers are
/// the same for all, turned to where the rest is simplest. Nothing if no number is.
std::optional<SupportScore> degenerate_support(const RayBlock& rays, const RayShape& shape,
                                               double tolerance_mm, Progress& progress) {
  std::vector<Support> best;
  int min = 4;
  // Where rays start on a line they say so exactly; the virtual focus is only near it.
  const SurfaceGuess starts = guess_surface(rays);
  const bool line = starts.shape == StartShape::line;
  // Lines through a point also meet every axis through it: there an axis must do better than a focus. Lines
  // through an axis have three numbers on both, but only the axis knows where they start.
  for (const SupportKind kind : {SupportKind::focal, SupportKind::axis}) {
    const int beaten = min;
    std::vector<Frame> frames;
    if (line) frames.push_back(upright_frame(starts.line, starts.point_mm));
    for (const Direction& axis : shape.axes) frames.push_back(upright_frame(axis, shape.focus_mm));
    for (const Frame& frame : frames) {
      Support s;
      s.kind = kind;
      s.world_from_support = frame;
      const Projection p = project(rays, rays.weight, bounded(s, rays), tolerance_mm);
      if (p.charts.empty() || p.missed_weight > 1e-3 * (p.weight + p.missed_weight)) continue;
      int dimensions = 0;
      for (std::size_t d = 0; d < 4; ++d) dimensions += p.charts.front().box.width(d) > 0.0 ? 1 : 0;
      const bool wins = kind == SupportKind::focal || dimensions < beaten || dimensions == 3;
      if (!wins || dimensions > min) continue;
      if (dimensions < min || (dimensions == 3 && best.front().kind != kind)) best.clear();
      min = dimensions;
      best.push_back(s);
    }
  }
  if (best.empty() || min == 4) return std::nullopt;
  const HeldOutScorer scorer(rays, shape.focus_mm, tolerance_mm);
  const SupportScore start = best_first(scorer.scores(best)).front();
  // Only turns leave the rays' numbers few; turns of a line's axis do not even that.
  const bool free = start.on.support.kind == SupportKind::focal && min == 2;
  return free ? refine(scorer, start, 0.0, radians(12.0), 8, progress) : start;
}

/// Supports that are searched alike.
std::size_t family(const Support& s) {
  return static_cast<std::size_t>(s.kind) + (s.dome.exists() ? kSupportKinds : 0);
}

}  // namespace

double rounding_mm(const RayBlock& rays, const Vec3& about_mm) {
  double farthest = 0.0, size = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    farthest = std::max(farthest, length(rays.origin_mm(i) - about_mm));
    size = std::max(size, length(rays.origin_mm(i)));
  }
  return 2e-6 * (farthest + size) + 1e-12;
}

RayBlock stratified_choice(const RayBlock& rays, std::size_t n, std::uint64_t seed) {
  if (rays.size() <= n) return rays;
  RayBlock chosen;
  const double stretch = static_cast<double>(rays.size()) / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double place = (static_cast<double>(i) + Rng(seed, i).uniform()) * stretch;
    chosen.append(rays, std::min(static_cast<std::size_t>(place), rays.size() - 1));
  }
  return chosen;
}

SearchResult search_support(const RayBlock& rays, const BoundingSurface& surface, std::uint64_t seed,
                            Progress& progress) {
  const RayBlock fine = stratified_choice(rays, kFineRays, seed);
  const RayBlock coarse = stratified_choice(fine, kCoarseRays, seed + 1);
  const RayShape shape = shape_of(coarse, summarize(rays), surface);
  const double tolerance_mm = rounding_mm(fine, shape.focus_mm);
  SearchResult result;
  if (const auto flat = degenerate_support(coarse, shape, tolerance_mm, progress)) {
    result.best = *flat;
    result.degenerate = true;
    return result;
  }
  progress.step("compress: supports", 0, 2);
  const HeldOutScorer screen(stratified_choice(coarse, kScreenRays, seed + 2), shape.focus_mm, tolerance_mm);
  std::vector<Support> promising;
  std::array<std::size_t, 2 * kSupportKinds> of_kind{};
  for (const SupportScore& score : best_first(screen.scores(candidates(coarse, shape, surface)))) {
    if (of_kind[family(score.on.support)]++ < 2 * kRefinedOfKind) promising.push_back(score.on.support);
  }
  const HeldOutScorer scorer(coarse, shape.focus_mm, tolerance_mm);
  std::vector<SupportScore> racers;
  of_kind.fill(0);
  for (const SupportScore& score : best_first(scorer.scores(promising))) {
    std::size_t& count = of_kind[family(score.on.support)];
    if (racers.size() < kRefined && count++ < kRefinedOfKind) racers.push_back(score);
  }
  double length_mm = 0.25 * shape.spread_mm, angle = radians(12.0);
  for (std::size_t round = 0; round < kRacers.size(); ++round, length_mm *= 0.5, angle *= 0.5) {
    for (SupportScore& racer : racers)
      racer = refine_round(scorer, std::move(racer), length_mm, angle, progress);
    racers = best_first(std::move(racers));
    for (; racers.size() > kRacers[round]; racers.pop_back()) result.runners_up.push_back(racers.back());
  }
  progress.step("compress: supports", 1, 2);
  result.runners_up.insert(result.runners_up.end(), racers.begin() + 1, racers.end());
  result.runners_up = best_first(std::move(result.runners_up));
  result.coarse_nats = racers.front().nats;
  result.best = std::move(racers.front());
  result.step_mm = length_mm, result.step_rad = angle;
  result.focus_mm = shape.focus_mm, result.tolerance_mm = tolerance_mm;
  return result;
}

void polish(SearchResult& found, const RayBlock& rays, std::uint64_t seed, Progress& progress) {
  if (found.degenerate) return;
  const HeldOutScorer fine(stratified_choice(rays, kFineRays, seed), found.focus_mm, found.tolerance_mm);
  found.best =
      refine(fine, fine.score(found.best.on.support), found.step_mm, found.step_rad, kFineRounds, progress);
  const HeldOutScorer last(stratified_choice(rays, kPolishRays, seed + 3), found.focus_mm, found.tolerance_mm,
                           2);
  found.best = polish_support(last, found.best.on.support, found.step_mm, found.step_rad, progress);
}

}  // namespace lucerna
