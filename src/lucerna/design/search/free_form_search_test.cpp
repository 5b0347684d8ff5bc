// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/free_form_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lucerna/design/search/checkpoint.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "tests/support/local_peers.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kSearchRays = std::uint64_t{1} << 15;

/// A disk of 1 mm that shines down into a mirror of 60 mm, 15 mm above its given vertex.
DesignRays disk_rays() {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 0.5;
  PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 15}), {}};
  return DesignRays({source}, Frame(), 3);
}

/// A cylinder of 16 mm across the axis of the same mirror.
DesignRays cylinder_rays() {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  options.radius_mm = 0.5;
  options.length_mm = 16.0;
  return DesignRays({{make_emitter(options), Frame({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 15}), {}}},
                    Frame(), 3);
}

/// A thin rod of 60 mm along y, 15 mm above the vertex.
DesignRays rod_rays(std::uint64_t seed) {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  options.radius_mm = 0.4;
  options.length_mm = 60.0;
  return DesignRays({{make_emitter(options), Frame({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, 15}), {}}},
                    Frame(), seed);
}

/// A smooth oval beam along +z of the mirror's frame.
FitProblem oval_problem(DesignRays& rays) {
  rays.grow(std::uint64_t{1} << 14);
  FitProblem p{&rays, Reflectance(0.9), {}, TentBins::square(Frame(), 0.6, 48), TargetMode::shape};
  p.target = [](const TentBins& bins) {
    const std::vector<double> flux = bins.flux_of([](const Direction& d) {
      const double u = d.x() / 0.25, v = d.y() / 0.15;
      return d.z() > 0.0 ? std::exp(-(u * u + v * v)) : 0.0;
    });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size())));
  };
  p.flux_weight = 0.01;
  p.flux_reference = 0.9;
  p.rectangle = {Frame(), false, -0.5, 0.5, -0.3, 0.3};
  return p;
}

DesignShape plain() { return DesignShape::bspline(15, Aperture::circle(60, 4), 8, 8); }

/// Error of a shape in bins that the search does not use, by rays that it does not use either.
double error_of(const FitProblem& problem, const DesignShape& shape, DesignRays fresh = disk_rays()) {
  fresh.grow(std::uint64_t{1} << 17);
  const TentBins bins = graded_bins(problem.rectangle, Frame(), 24, 1.1);
  EvaluationOptions options;
  options.rays = std::uint64_t{1} << 17;
  options.derivatives = false;
  return bin_error(evaluate(shape, problem.reflectance, fresh, bins, options), problem.target(bins), bins,
                   problem.mode)
      .relative_rms;
}

FreeFormSearch run(const FitProblem& problem, const DesignShape& given, int steps, FreeFormState state = {}) {
  FreeFormSearch search(problem, given, 16, kSearchRays, std::move(state));
  for (int i = 0; i < steps && !search.done(); ++i) search.step();
  return search;
}

TEST(TransportGuess, IsNearTheTargetForBothSigns) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  rays.grow(std::uint64_t{1} << 18);
  const TentBins bins = graded_bins(problem.rectangle, Frame(), 32, 1.1, 0);
  const TransportProblem transport{&rays, std::uint64_t{1} << 18, 0.9, true, problem.target(bins), bins};
  const DesignShape family = DesignShape::bspline(15, Aperture::circle(60, 4), 24, 24);
  EXPECT_GT(error_of(problem, family), 0.8) << "the paraboloid is far off, or the test says nothing";
  for (const TransportChoice choice : {TransportChoice{-1.0, 10.0}, TransportChoice{1.0, 24.0}}) {
    const auto start = transport_guess(transport, family, choice);
    ASSERT_TRUE(start) << choice.sign;
    EXPECT_NEAR(start->at(0.0, 0.0).z_mm, 15.0 - choice.vertex_distance_mm, 0.3) << choice.sign;
    EXPECT_LT(error_of(problem, *start), 0.12) << choice.sign;
  }
}

TEST(TransportGuess, IsNothingWhereNoMirrorCanBe) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const TentBins bins = graded_bins(problem.rectangle, Frame(), 32, 1.1, 0);
  const TransportProblem transport{&rays, rays.size(), 0.9, true, problem.target(bins), bins};
  EXPECT_FALSE(transport_guess(transport, plain(), {1.0, 3.0})) << "it would close before it reaches the rim";
}

TEST(FittedToPoints, GoesThroughASmoothSurfaceAndBeyondItsPoints) {
  std::vector<SurfacePointWeight> points;
  const auto height = [](double x, double y) { return 0.02 * x * x + 0.01 * y * y - 0.03 * x * y - 4.0; };
  for (double x = -25; x <= 25; x += 0.5) {
    for (double y = -25; y <= 25; y += 0.5) {
      if (x * x + y * y < 625) points.push_back({x, y, height(x, y), 1.0});
    }
  }
  const DesignShape fitted = fitted_to_points(DesignShape::bspline(15, Aperture::circle(60), 20, 20), points);
  EXPECT_NEAR(fitted.at(3.0, -7.0).z_mm, height(3.0, -7.0), 1e-6);
  EXPECT_NEAR(fitted.at(29.0, 0.0).z_mm, height(29.0, 0.0), 1e-3) << "quadratics have no third differences";
}

TEST(FreeFormSearch, ReachesAFarTargetFromThePlainParaboloid) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const FreeFormSearch search = run(problem, plain(), 60);
  EXPECT_LT(error_of(problem, search.best()), 0.06);  // 32 k rays fitted: half of it is their noise
}

// A rod along a trough. Its light falls evenly over 50 degrees across, twice as bright on one side.
TEST(FreeFormSearch, ATroughReachesAFarTarget) {
  DesignRays rays = rod_rays(3);
  FitProblem problem = oval_problem(rays);
  const double half = radians(25.0);
  problem.target = [&](const TentBins& bins) {
    const std::vector<double> flux = bins.flux_of([&](const Direction& d) {
      const double across = std::atan2(d.x(), d.z());
      return d.z() > 0.0 && std::abs(across) < half ? (across > 0.0 ? 2.0 : 1.0) * std::hypot(d.x(), d.z())
                                                    : 0.0;
    });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size())));
  };
  problem.rectangle = {Frame(), false, -0.42, 0.42, -0.9, 0.9};
  const DesignShape given = DesignShape::trough(15, Aperture::rectangle(60, 300), 8);
  const FreeFormSearch search = run(problem, given, 60);
  const DesignShape best = search.best();
  EXPECT_TRUE(best.is_trough());
  EXPECT_EQ(best.intervals_y(), 1);
  EXPECT_GT(best.intervals_x(), given.intervals_x());
  EXPECT_GT(error_of(problem, given, rod_rays(4)), 0.5)
      << "the parabola is far off, or the test says nothing";
  EXPECT_LT(error_of(problem, best, rod_rays(4)), 0.25);  // along the trough it cannot be met
}

TEST(FreeFormSearch, EndsAtTheSameBitsHoweverOftenItWasStopped) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const std::string whole = checkpoint_text(run(problem, plain(), 40).state(), "key");
  FreeFormState state;
  for (const int steps : {1, 2, 13, 14, 10}) {
    DesignRays others = disk_rays();
    const FitProblem again = oval_problem(others);
    state = parse_search_checkpoint(checkpoint_text(run(again, plain(), steps, state).state(), "key"), "key");
  }
  EXPECT_EQ(checkpoint_text(state, "key"), whole);
}

/// A search whose best, a neighbour, is fitted to the end.
FreeFormState with_neighbours_next(double cost) {
  DesignRays rays = disk_rays();
  FreeFormState state = run(oval_problem(rays), plain(), 20).state();
  FreeFormSnapshot best = state.done.back();
  best.candidate = 20;
  best.transport = {1.0, 22.0};
  best.cost = cost;
  best.error_to_noise = 10.0;
  state.now = {};
  state.step = 0;
  state.done.clear();
  for (int level = 0; level < kFreeFormLevels; ++level) {
    best.level = level;
    state.done.push_back(best);
  }
  state.begun = 21;
  return state;
}

/// State and record after each of the first steps.
std::vector<std::string> steps_of(DesignRays rays, const FreeFormState& start, int steps, bool ahead) {
  const FitProblem problem = oval_problem(rays);
  FreeFormSearch search(problem, plain(), 16, kSearchRays, start);
  std::vector<std::string> out;
  for (int i = 0; i < steps && !search.done(); ++i) {
    const auto record = search.step();
    if (i == 0) {
      EXPECT_EQ(search.next_rays() == 0, ahead) << "the next step is known already";
    }
    out.push_back(checkpoint_text(search.state(), "key"));
    if (!record) continue;
    for (const double x : {record->error, record->floor, record->in_rectangle, record->efficiency,
                           record->lambda, static_cast<double>(record->total_rays)})
      out.back() += fmt::format("{:a} ", x);
  }
  return out;
}

/// Expects them of `n` peers, which fit rough levels ahead, as of one process; returns that one's last state.
FreeFormState expect_same_steps(DesignRays (*rays)(), int steps, const std::vector<int>& peer_counts,
                                const FreeFormState& start = {}) {
  const std::vector<std::string> alone = steps_of(rays(), start, steps, false);
  for (const int n : peer_counts) {
    std::vector<std::vector<std::string>> found(static_cast<std::size_t>(n));
    const auto errors = test::on_peers(n, [&](Peers& peers) {
      DesignRays own = rays();
      own.share_with(&peers);
      found[static_cast<std::size_t>(peers.rank())] = steps_of(std::move(own), start, steps, true);
    });
    for (const std::string& e : errors) EXPECT_EQ(e, "");
    for (const auto& of_peer : found) {
      EXPECT_EQ(of_peer.size(), alone.size());
      const auto differ = std::mismatch(alone.begin(), alone.end(), of_peer.begin(), of_peer.end());
      if (differ.first == alone.end() || differ.second == of_peer.end()) continue;
      ADD_FAILURE() << n << " peers, step " << differ.first - alone.begin() << ":\n"
                    << *differ.second << "\nalone:\n"
                    << *differ.first;
    }
  }
  return parse_search_checkpoint(alone.back(), "key");
}

TEST(FreeFormSearch, CandidatesFittedAheadLeadToTheSameSteps) { expect_same_steps(disk_rays, 14, {3}); }

// Also where others end a rough level early, where an approach comes next, and among neighbours, of which the
// last are no longer worth going on with.
TEST(FreeFormSearchSlow, CandidatesFittedAheadLeadToTheSameSteps) {
  expect_same_steps(disk_rays, 120, {2, 12});
  for (const double cost : {1e-9, 1e-2}) {
    EXPECT_GT(expect_same_steps(disk_rays, 40, {2, 3}, with_neighbours_next(cost)).begun, 22) << cost;
  }
  const FreeFormState of_long = expect_same_steps(cylinder_rays, 60, {2, 3, 12});
  EXPECT_TRUE(std::any_of(of_long.done.begin(), of_long.done.end(), [](const FreeFormSnapshot& m) {
    return m.candidate > 3 && !m.transport.exists();
  })) << "approaches";
}

// Its levels have fewer bins, and what follows from that.
TEST(FreeFormSearch, OfALongSourceALevelGoesOnToTheSameBits) {
  DesignRays rays = cylinder_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormSearch whole(problem, plain(), 16, kSearchRays);
  constexpr int kFineBins = 84;
  const auto is_there = [&] {
    const FreeFormState& s = whole.state();
    return s.now.level == 1 && s.now.bins < kFineBins && s.step == 1;
  };
  for (int i = 0; i < 300 && !is_there(); ++i) whole.step();
  ASSERT_TRUE(is_there());
  FreeFormSearch again(problem, plain(), 16, kSearchRays,
                       parse_search_checkpoint(checkpoint_text(whole.state(), "key"), "key"));
  for (int i = 0; i < 3; ++i) {
    whole.step();
    again.step();
  }
  EXPECT_EQ(checkpoint_text(again.state(), "key"), checkpoint_text(whole.state(), "key"));
}

// The mirror of a point source is no guide for a long one: the given mirror is brought near it instead.
TEST(FreeFormSearch, OfALongSourceTheGivenMirrorIsBroughtNear) {
  DesignRays rays = cylinder_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormState state = run(problem, plain(), 50).state();
  const auto cost = [&](bool approach) {
    double least = 1e9;
    for (const FreeFormSnapshot& m : state.done) {
      if (m.level == 0 && (m.candidate >= 3 && !m.transport.exists()) == approach)
        least = std::min(least, m.cost);
    }
    return least;
  };
  EXPECT_LT(cost(true), 0.8 * cost(false));  // 0.57
  for (const FreeFormSnapshot& m : state.done) {
    if (m.candidate < 3 || m.transport.exists()) continue;
    EXPECT_EQ(m.intervals_x, 16) << "eight were too few";
  }
}

/// A search that has come to the end of its first candidates' rough levels; what these cost.
FreeFormState candidates_of(const std::vector<double>& costs) {
  FreeFormState state;
  const DesignShape shape = plain();
  for (const double cost : costs) {
    FreeFormSnapshot m;
    m.candidate = state.begun++;
    m.level = 0;
    m.cost = cost;
    m.error = std::sqrt(cost / 0.3);
    if (m.candidate > 0) m.transport = {-1.0, 10.0};
    m.parameters.assign(shape.parameters().begin(), shape.parameters().end());
    m.intervals_x = m.intervals_y = 8;
    m.bins = 64;
    state.done.push_back(m);
  }
  return state;
}

// A search that has little time is to end with a fine mirror.
TEST(FreeFormSearch, TheBestOfAFewIsFittedFinelyBeforeTheOthersBegin) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const FreeFormState state = run(problem, plain(), 1, candidates_of({4e-3, 1e-4, 5e-3})).state();
  EXPECT_EQ(state.now.candidate, 1);
  EXPECT_EQ(state.now.level, 1);
}

// Where no mirror of a point source is at the target, an approach of the given mirror comes next. What is
// at the noise then goes on alone, with its few knots.
TEST(FreeFormSearch, AGivenMirrorIsBroughtNearerWhereNoneIsAtTheTarget) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormState state = run(problem, plain(), 1, candidates_of({4e-3, 3e-3, 5e-3})).state();
  ASSERT_EQ(state.now.candidate, 3);
  EXPECT_FALSE(state.now.transport.exists());
  state.done.push_back(state.done.front());
  state.done.back().candidate = 3;
  state.done.back().cost = 1e-5;
  state.done.back().error = 5e-3;
  state.done.back().error_to_noise = 1.0;
  state.now = {};
  const FreeFormSearch next = run(problem, plain(), 1, state);
  EXPECT_EQ(next.state().now.candidate, 3);
  EXPECT_EQ(next.state().now.level, 1);
  EXPECT_EQ(next.state().now.intervals_x, 8);
}

// Near, yet above the noise on the fine level: only its own family may come nearer, from other starts, until
// one is at the noise.
TEST(FreeFormSearch, AGivenMirrorThatIsStuckIsApproachedAtOnce) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormState state = candidates_of({5e-6});
  FreeFormSnapshot fine = state.done.front();
  fine.level = 1;
  fine.error_to_noise = 3.0;
  state.done.push_back(fine);
  state = run(problem, plain(), 1, state).state();
  ASSERT_EQ(state.now.candidate, 3);
  EXPECT_EQ(state.begun, 4);
  for (const double over_noise : {1.3, 1.05}) {
    FreeFormState next = state;
    next.done.push_back(next.done.front());
    next.done.back().candidate = 3;
    next.done.back().cost = 2e-6;
    next.done.back().error_to_noise = over_noise;
    next.now = {};
    next = run(problem, plain(), 1, next).state();
    EXPECT_EQ(next.now.candidate == 4, over_noise > 1.2) << over_noise;
  }
}

// Approaches end in basins of their own, so that several are compared, as long as none
// is at the target.
TEST(FreeFormSearch, FurtherApproachesFollowUntilOneIsNear) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormState state = candidates_of({3e-3, 4e-3, 5e-3});
  FreeFormSnapshot approach = state.done.front();
  approach.candidate = state.begun++;
  approach.cost = 2e-3;
  approach.error = 0.08;
  state.done.push_back(approach);
  approach.candidate = state.begun++;
  approach.cost = 2.5e-3;
  state.done.push_back(approach);
  state = run(problem, plain(), 1, state).state();
  ASSERT_EQ(state.now.candidate, 3);
  ASSERT_EQ(state.now.level, 1);
  state.done.push_back(state.now);
  state.now = {};
  state = run(problem, plain(), 1, state).state();
  ASSERT_EQ(state.now.candidate, 3);
  ASSERT_EQ(state.now.level, 2);
  state.step = 4;  // the fifth is the last before others begin
  state = run(problem, plain(), 1, state).state();
  ASSERT_FALSE(state.now.exists());
  state = run(problem, plain(), 1, state).state();
  ASSERT_EQ(state.now.candidate, 5);
  EXPECT_FALSE(state.now.transport.exists());
  state.done.push_back(state.now);
  state.now = {};
  state.done.back().cost = 1e-5;
  for (FreeFormSnapshot& m : state.done) {
    m.cost = std::min(m.cost, 2e-5);
    m.error = std::min(m.error, 8e-3);
    m.error_to_noise = 1.0;
  }
  state = run(problem, plain(), 1, state).state();
  EXPECT_EQ(state.begun, 6) << "no more approaches";
  EXPECT_EQ(state.now.level, 1);
}

TEST(FreeFormSearch, TheNearestOfAllApproachesGoesToTheEnd) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  for (const double cost : {1e-3, 3e-3}) {
    FreeFormState state = candidates_of({3e-3, 4e-3, 5e-3});
    FreeFormSnapshot approach = state.done.front();
    const auto add = [&](int candidate, int level, double with) {
      approach.candidate = candidate;
      approach.level = level;
      approach.cost = with;
      state.done.push_back(approach);
    };
    for (const int candidate : {3, 7, 8}) add(candidate, 0, 2e-3);
    for (const int level : {1, 2}) add(3, level, 2e-3);
    add(7, 1, cost);
    add(8, 1, 1.0);
    state.begun = 11;
    state = run(problem, plain(), 1, state).state();
    EXPECT_EQ(state.now.candidate, cost < 2e-3 ? 7 : 3);
    EXPECT_EQ(state.now.level, cost < 2e-3 ? 2 : 3);
  }
}

// What five fine steps of the best had left says whether another is worth its time.
TEST(FreeFormSearch, AnApproachThatLagsBehindEndsEarly) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  for (const double early : {1e-9, 1e9}) {
    FreeFormState state = candidates_of({3e-3, 4e-3, 5e-3});
    FreeFormSnapshot best = state.done.front();
    best.candidate = 3;
    best.level = 1;
    best.early_cost = early;
    state.done.push_back(best);
    state.now = best;
    state.now.candidate = 4;
    state.begun = 5;
    state.step = 4;
    state.costs = {1e9};
    state = run(problem, plain(), 1, state).state();
    EXPECT_EQ(state.now.exists(), early > 1.0) << early;
  }
}

// Neighbours are made about the best, which may be a neighbour itself: that once never ended.
TEST(FreeFormSearch, ANeighbourThatIsTheBestHasNeighbours) {
  DesignRays rays = disk_rays();
  FitProblem problem = oval_problem(rays);
  problem.max_failed_restarts = 1000;
  const FreeFormSearch search = run(problem, plain(), 1, with_neighbours_next(1e-9));
  EXPECT_GE(search.state().now.candidate, 21);
  EXPECT_EQ(search.state().now.transport.sign, 1.0);
  EXPECT_NEAR(search.state().now.transport.vertex_distance_mm, 22.0, 0.31 * 22.0);
}

// No ray hits the mirror and none of the rest counts: nothing tells of any parameter.
TEST(FreeFormSearch, EndsAStepThatNoLightTellsOf) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 0.5;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 200}), {}}}, Frame(),
                  3);
  FitProblem problem = oval_problem(rays);
  problem.mode = TargetMode::absolute;
  problem.direct_light = false;
  FreeFormLevel level;
  level.rays = kSearchRays;
  const FreeFormFit fit(problem, level);
  FreeFormPoint point = fit.at(plain());
  double lambda = 1e-2;
  EXPECT_FALSE(fit.step(point, lambda));
}

// Tried without derivatives first, a step is the same.
TEST(FreeFormSearch, ADoubtfulStepHasTheSameBits) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  FreeFormLevel level;
  level.rays = kSearchRays;
  const FreeFormFit fit(problem, level);
  FreeFormPoint point = fit.at(plain()), doubtful = fit.at(plain());
  EXPECT_EQ(fit.at(plain(), false).equations.cost, point.equations.cost);
  double lambda = 1e-2, lambda_doubtful = lambda;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(fit.step(point, lambda), fit.step(doubtful, lambda_doubtful, true)) << i;
    EXPECT_EQ(lambda, lambda_doubtful) << i;
    EXPECT_EQ(point.shape.parameters(), doubtful.shape.parameters()) << i;
    EXPECT_EQ(point.equations.gradient, doubtful.equations.gradient) << i;
  }
}

TEST(FreeFormSearch, RefusesCheckpointsThatAreCutOrOfAnotherProblem) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const std::string text = checkpoint_text(run(problem, plain(), 3).state(), "key");
  EXPECT_THROW(parse_search_checkpoint(text, "other"), InputError);
  for (std::size_t n = 0; n + 1 < text.size(); n += 1 + text.size() / 200) {
    EXPECT_THROW(parse_search_checkpoint(text.substr(0, n), "key"), InputError) << n;
  }
}

TEST(FreeFormSearch, NeverEndsWorseThanItsStartAndNeverCoarsensIt) {
  DesignRays rays = disk_rays();
  const FitProblem problem = oval_problem(rays);
  const DesignShape found = run(problem, plain(), 30).best();
  ASSERT_GE(found.intervals_x(), 16);
  for (const std::uint64_t seed : {1, 2, 4}) {
    // Perturbed: from nearly right to far off.
    const DesignShape given = perturbed(found, 0.01 * static_cast<double>(seed * seed), Rng(seed, 0));
    const double before = error_of(problem, given);
    for (const int steps : {1, 12}) {
      const DesignShape best = run(problem, given, steps).best();
      EXPECT_GE(best.intervals_x(), given.intervals_x());
      EXPECT_LT(error_of(problem, best), 1.02 * before + 0.005) << seed << ' ' << steps;
    }
  }
}

}  // namespace
}  // namespace lucerna
