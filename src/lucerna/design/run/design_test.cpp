// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/constraints/source_side.h"
#include "lucerna/design/search/checkpoint.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/binning/binned_intensity.h"
#include "lucerna/random.h"
#include "lucerna/trace.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;

constexpr const char* kSource = R"(
[[source]]
kind = "disk"
radius_mm = 1.0
[[detector]]
name = "far"
kind = "far-field"
c_step_deg = 90.0
gamma_step_deg = 1.0
)";

std::string mirror(const std::string& shape) {
  return "[[reflector]]\n" + shape +
         "diameter_mm = 60.0\nposition_mm = [0, 0, 8]\naxis = \"-z\"\nreflectance = 0.9\n";
}

/// What the tracer sees of a project.
struct Seen {
  IntensityDistribution distribution;
  double share_out;
};
Seen seen(const Project& project) {
  TraceOptions options;
  options.last_ray = 1 << 20;
  const TraceResult result = trace(project.scene, options);
  const FarField field = far_field(result, 0);
  std::vector<double> c, gamma;
  for (std::size_t i = 0; i < field.c_count; ++i) c.push_back(field.c_step_deg * static_cast<double>(i));
  for (std::size_t i = 0; i < field.gamma_count; ++i) {
    gamma.push_back(field.gamma_step_deg * static_cast<double>(i));
  }
  const Ledger l = ledger(result);
  return {intensity_from_bins(c, gamma, field.flux, {}).distribution,
          (l.out_direct.mean + l.out_reflected.mean) / l.emitted};
}

/// Relative RMS between the ring means of two distributions on one grid, weighted by solid angle.
double ring_difference(const IntensityDistribution& a, const IntensityDistribution& b) {
  const std::vector<double> w = ring_weights_sr(a.gamma_deg), p = ring_means(a), q = ring_means(b);
  double difference = 0.0, norm = 0.0;
  for (std::size_t g = 0; g < w.size(); ++g) {
    difference += w[g] * (p[g] - q[g]) * (p[g] - q[g]);
    norm += w[g] * p[g] * p[g];
  }
  return std::sqrt(difference / norm);
}

/// A target that is known to be reachable: the light of a hidden profile, written as an IES file.
void write_target(const std::filesystem::path& folder) {
  write_file(
      folder / "hidden.toml",
      kSource + mirror("family = \"revolution\"\nprofile_mm = [[0, 0], [8, 2.05], [16, 8.2], [24, 17.6], "
                       "[30, 26.8]]\n"));
  PhotometricFile file;
  file.distribution = seen(read_project(folder / "hidden.toml")).distribution;
  write_photometric_file(folder / "target.ies", file, PhotometricFormat::ies_2019);
}

DesignProblem problem(
    const std::filesystem::path& folder, const std::string& design = "",
    const std::string& shape = "family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n") {
  write_file(folder / "project.toml",
             kSource + mirror(shape) + "[target]\nfile = \"target.ies\"\n[design]\n" +
                 (design.find("restarts") == std::string::npos ? "restarts = 0\n" : "") + design);
  return design_problem(read_project(folder / "project.toml"), folder / "project.toml");
}

DesignOptions small() {
  DesignOptions options;
  options.time_s = 1e6;
  options.max_rays = 1 << 14;
  options.validation_rays = 1 << 16;
  return options;
}

/// Where only the way counts.
DesignOptions tiny() {
  DesignOptions options = small();
  options.max_rays = 1 << 13;
  return options;
}

TEST(Design, ReachesTheLightOfAHiddenProfile) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p = problem(folder.path(), "intervals = 8\n");
  const DesignResult result = design(p, small());
  EXPECT_EQ(result.end, DesignTermination::converged);
  EXPECT_GT(result.start_error.c12.excess, 0.12);
  EXPECT_LT(result.error.c12.excess, 0.03);  // 0.010 with a standard error of 0.008
  EXPECT_NEAR(result.efficiency.mean + result.absorbed.mean + result.back.mean + result.lost.mean, 1.0, 1e-9);

  // The tracer, on the project that the design leaves, sees the same light.
  write_file(folder.path() / "result.toml", project_text(with_shape(p, result.shape)));
  const Seen traced = seen(read_project(folder.path() / "result.toml"));
  EXPECT_NEAR(traced.share_out, result.efficiency.mean, 0.002);
  EXPECT_LT(ring_difference(p.target.distribution, traced.distribution), 0.05);
  EXPECT_GT(ring_difference(p.target.distribution, seen(p.project).distribution), 0.12);
}

TEST(Design, ResumesToTheSameBits) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p = problem(folder.path(), "intervals = 2\nrestarts = 1\n");
  std::vector<std::string> states;
  const DesignResult whole = design(
      p, tiny(), no_progress(),
      [&](const FitRecord&, const DesignShape&, const std::string& state) { states.push_back(state); });
  ASSERT_GT(states.size(), 8u);
  EXPECT_LE(parse_checkpoint(whole.checkpoint, whole.checkpoint.substr(32, 16)).restart.failed, 1);
  for (const std::size_t at : {states.size() / 4, states.size() - 4}) {
    DesignOptions options = tiny();
    options.checkpoint = states[at];
    const DesignResult resumed = design(p, options);
    EXPECT_EQ(resumed.checkpoint, whole.checkpoint) << "from step " << at;
    EXPECT_EQ(resumed.shape.parameters(), whole.shape.parameters()) << "from step " << at;
  }
}

TEST(Design, ResumesInTheMiddleOfASearchToTheSameBits) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p = problem(folder.path(), "intervals = 1\noptimizer = \"cma-es\"\n");
  std::vector<std::string> states;
  const DesignResult whole =
      design(p, tiny(), no_progress(), [&](const FitRecord& r, const DesignShape&, const std::string& state) {
        if (r.stage < 0) states.push_back(state);
      });
  ASSERT_GT(states.size(), 8u);
  DesignOptions options = tiny();
  options.checkpoint = states[states.size() / 2];
  const DesignResult resumed = design(p, options);
  EXPECT_EQ(resumed.checkpoint, whole.checkpoint);
  EXPECT_LT(resumed.history.size(), whole.history.size());
}

constexpr const char* kFreeForm = "family = \"bspline\"\nfocal_mm = 8\n";

TEST(Design, WithoutATradeBetweenErrorAndLightIsRefusedAtOnce) {
  const TempDir folder;
  write_target(folder.path());
  DesignOptions options = small();
  options.pareto = true;
  const auto refusal = [&](const std::string& keys, const std::string& shape) {
    const DesignProblem p = problem(folder.path(), keys, shape);
    return test::message_of<InputError>([&] { static_cast<void>(design(p, options)); });
  };
  EXPECT_THAT(refusal("", "family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n"),
              testing::HasSubstr("found family = \"revolution\""));
  EXPECT_THAT(refusal("optimizer = \"least-squares\"\n", kFreeForm),
              testing::HasSubstr("found optimizer = \"least-squares\""));
}

/// Takes a design up from what `chosen` says of its states, one for each figure, and expects the same bits.
void expect_same_end(const DesignProblem& p, const std::function<int(const FitState&)>& chosen, int figures,
                     DesignOptions options = tiny()) {
  std::vector<std::string> from(static_cast<std::size_t>(figures));
  const DesignResult whole =
      design(p, options, no_progress(), [&](const FitRecord&, const DesignShape&, const std::string& state) {
        const int figure = chosen(parse_checkpoint(state, state.substr(32, 16)));
        if (figure >= 0) from[static_cast<std::size_t>(figure)] = state;
      });
  for (const std::string& state : from) {
    ASSERT_FALSE(state.empty());
    options.checkpoint = state;
    const DesignResult resumed = design(p, options);
    EXPECT_EQ(resumed.checkpoint, whole.checkpoint);
    EXPECT_EQ(resumed.shape.parameters(), whole.shape.parameters());
    EXPECT_LT(resumed.history.size(), whole.history.size());
  }
}

TEST(Design, ResumesInTheMiddleOfASearchRestartToTheSameBits) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p =
      problem(folder.path(), "intervals = [1, 1]\nrestarts = 2\noptimizer = \"least-squares\"\n", kFreeForm);
  const auto within = [](const FitState& s) {
    if (s.restart.searches < 2 || s.step < 1) return -1;
    return s.restart.conjugate ? 1 : 0;
  };
  expect_same_end(p, within, 2);
}

TEST(Design, ResumesWhereKnotsHaveGrownToTheSameBits) {
  const TempDir folder;
  write_target(folder.path());
  DesignProblem p = problem(folder.path(), "intervals = [1, 1]\noptimizer = \"least-squares\"\n", kFreeForm);
  p.knot_doublings = 1;
  DesignOptions options = tiny();
  options.max_rays = 1 << 16;
  const auto grown = [](const FitState& s) { return s.intervals_x == 2 && s.step == 1 ? 0 : -1; };
  expect_same_end(p, grown, 1, options);
}

/// Whatever looks for the basin, the light comes nearer to the target and stays whole.
TEST(Design, EveryOptimizerIsSensible) {
  const TempDir folder;
  write_target(folder.path());
  for (const char* name : {"least-squares", "tree", "annealing", "cma-es", "direct"}) {
    const DesignProblem p = problem(folder.path(), fmt::format("intervals = 1\noptimizer = \"{}\"\n", name));
    DesignOptions options = tiny();
    const DesignResult result = design(p, options);
    EXPECT_EQ(result.end, DesignTermination::converged) << name;
    EXPECT_LT(result.error.c12.excess, 0.36 * result.start_error.c12.excess) << name;  // 0.20 to 0.24
    EXPECT_NEAR(result.efficiency.mean + result.absorbed.mean + result.back.mean + result.lost.mean, 1.0,
                1e-9)
        << name;
    EXPECT_GT(result.efficiency.mean, 0.8) << name;
  }
}

/// A budget that ends within the search leaves the best so far, whole, and a state that goes on.
TEST(Design, TimeMayEndWithinASearch) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p = problem(folder.path(), "intervals = 2\noptimizer = \"tree\"\n");
  DesignOptions options = tiny();
  options.time_s = 1e-9;
  const DesignResult result = design(p, options);
  EXPECT_EQ(result.end, DesignTermination::time);
  EXPECT_EQ(result.history.size(), 1u);
  EXPECT_GT(result.rays, 0u);
  EXPECT_GT(result.efficiency.mean, 0.5);
  EXPECT_FALSE(parse_checkpoint(result.checkpoint, result.checkpoint.substr(32, 16)).search_costs.empty());
}

TEST(Design, RefusesForeignAndDamagedCheckpoints) {
  FitState state;
  state.parameters = {1.0, -0.1, 1e-300};
  const std::string text = checkpoint_text(state, "0123456789abcdef");
  EXPECT_EQ(checkpoint_text(parse_checkpoint(text, "0123456789abcdef"), "0123456789abcdef"), text);
  EXPECT_THROW(parse_checkpoint(text, "another"), InputError);
  EXPECT_THROW(parse_checkpoint("", "0123456789abcdef"), InputError);
  for (std::size_t n = 0; n + 4 < text.size(); n += 7) {
    EXPECT_THROW(parse_checkpoint(text.substr(0, n), "0123456789abcdef"), InputError) << n;
  }
}

TEST(Design, HoldsTheHeightLimit) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem free = problem(folder.path(), "intervals = 6\n");
  const double height = free.start.height_mm();
  const DesignProblem held = problem(
      folder.path(), fmt::format("intervals = 6\n[design.limits]\nmax_height_mm = {}\n", 0.9 * height));
  const DesignResult result = design(held, small());
  EXPECT_LE(result.shape.height_mm(), 0.9 * height);
  EXPECT_GT(design(free, small()).shape.height_mm(), 0.9 * height);
}

TEST(Design, AFlatterMirrorDoesNotRisePastTheSource) {
  const TempDir folder;
  write_target(folder.path());
  // The given one is 28 mm high and the source 8 mm over its vertex: the nearest of 3 mm would be behind it.
  const DesignProblem p = problem(folder.path(), "intervals = 6\n[design.limits]\nmax_height_mm = 3\n");
  EXPECT_LE(p.start.height_mm(), 3.001);
  for (const double r : {0.0, 0.5, 1.0}) EXPECT_LT(p.start.at(r, 0.0).z_mm, 0.5) << r;
}

// Also where the project has no limits: the tracer refuses such a mirror.
TEST(Design, AMirrorThatPassesTheSourceCostsMoreThanAnyError) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p = problem(folder.path(), "", kFreeForm);
  DesignRays rays = design_rays(p, small(), 1);
  const FitProblem fit = fit_problem(p, small(), rays);
  const Eigen::VectorXd higher = p.start.parameters().array() + 8.5;
  const DesignShape through = p.start.with(higher);
  ASSERT_GT(share_behind(through, rays), 0.5);
  EXPECT_EQ(fit.limits_cost(p.start, 1 << 13, nullptr), 0.0);
  EXPECT_GT(fit.limits_cost(through, 1 << 13, nullptr), 1.0);
  EXPECT_FALSE(fit.within(through)) << "no start for a search";
  EXPECT_EQ(fit.within(p.start)->parameters(), p.start.parameters());
}

TEST(Design, ShapesAFreeFormMirrorAndKeepsItsSymmetry) {
  const TempDir folder;
  write_target(folder.path());
  const DesignProblem p =
      problem(folder.path(), "intervals = [4, 4]\n[design.limits]\nsymmetry = \"both\"\n", kFreeForm);
  EXPECT_EQ(p.start.parameter_count(), 16u);
  DesignOptions options = small();
  options.max_rays = 1 << 16;
  options.validation_rays = 1 << 18;
  const DesignResult result = design(p, options);
  EXPECT_LT(result.error.c12.excess, 0.45 * result.start_error.c12.excess);  // 0.32
  EXPECT_NEAR(result.shape.at(9, 4).z_mm, result.shape.at(-9, -4).z_mm, 1e-12);
  write_file(folder.path() / "result.toml", project_text(with_shape(p, result.shape)));
  const Project again = read_project(folder.path() / "result.toml");
  for (double x = -20; x <= 20; x += 5) {
    EXPECT_NEAR(again.scene.reflectors[0].reflector.surface->at(x, 7).z_mm, result.shape.at(x, 7).z_mm, 1e-9);
  }
}

/// Any mirror to begin with, of both families and with any time: what comes out is no worse by the printed
/// error.
TEST(DesignSlow, NeverEndsWorseThanARandomStart) {
  const TempDir folder;
  write_target(folder.path());
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Rng rng(seed, 0);
    const bool revolution = seed % 2 == 0;
    DesignProblem p = problem(folder.path(), fmt::format("intervals = {}\n", revolution ? "6" : "[4, 4]"),
                              fmt::format("{}focal_mm = {}\n",
                                          revolution ? "family = \"revolution\"\npreset = \"parabola\"\n"
                                                     : "family = \"bspline\"\n",
                                          6.0 + 6.0 * rng.uniform()));
    Eigen::VectorXd parameters = p.start.parameters();
    for (double& x : parameters) x += 2.0 * rng.uniform() - 1.0;
    p.start = p.start.with(parameters);
    DesignOptions options = small();
    options.seed = seed;
    options.time_s = 4.0 * rng.uniform();
    const DesignResult result = design(p, options);
    const BoxErrorEstimate &found = result.error.c48, &given = result.start_error.c48;
    EXPECT_LE(found.excess, given.excess + 4.0 * std::hypot(found.standard_error, given.standard_error))
        << "seed " << seed;
  }
}

TEST(DesignProblem, RefusesWhatLightPassesBeforeItsTimeIsSpent) {
  const TempDir folder;
  write_target(folder.path());
  const auto file = folder.path() / "project.toml";
  for (const char* body : {"role = \"glass\"\nname = \"pane\"\ndiameter_mm = 9\n",
                           "role = \"solid\"\nname = \"pane\"\noutline_mm = [[0, 0], [5, 0], [0, 4]]\n"}) {
    write_file(file, kSource + mirror("family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n") +
                         "[[body]]\nposition_mm = [0, 0, 200]\n" + body +
                         "[target]\nfile = \"target.ies\"\n");
    try {
      design_problem(read_project(file), file);
      FAIL() << "taken";
    } catch (const InputError& e) {
      EXPECT_EQ(e.cause(), ErrorCause::unsupported);
      EXPECT_THAT(std::string(e.what()), testing::HasSubstr("body: found 'pane', which light passes"));
    }
  }
}

TEST(DesignProblem, TheWrittenMirrorHasTheGivenSurface) {
  const TempDir folder;
  write_target(folder.path());
  const auto read = [&](const std::string& text) {
    write_file(folder / "project.toml", text);
    return design_problem(read_project(folder / "project.toml"), folder / "project.toml");
  };
  for (const char* surface :
       {"metal = \"silver\"\nwavelength_nm = 450\n", "reflectance = [[0, 0.9], [60, 0.8]]\n",
        "reflectance = 0.8\nscatter = [{ model = \"gaussian\", share = 0.2, sigma = 0.05 }]\n",
        "data_sheet = { total = 0.8, diffuse = 0.2 }\n"}) {
    std::string given_mirror = mirror("family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n");
    const std::string plain = "reflectance = 0.9\n";
    given_mirror.replace(given_mirror.find(plain), plain.size(), surface);
    const DesignProblem p =
        read(kSource + given_mirror + "slope_error_mrad = 3\n[target]\nfile = \"target.ies\"\n");
    const DesignProblem again = read(project_text(with_shape(p, p.start)));
    const PlacedReflector &given = p.project.scene.reflectors[0], &kept = again.project.scene.reflectors[0];
    EXPECT_LT(given.reflectance.at(1.0), 1.0);
    for (const double cosine : {0.1, 0.5, 1.0})
      EXPECT_EQ(kept.reflectance.at(cosine), given.reflectance.at(cosine));
    EXPECT_EQ(kept.slope_error_mrad, 3.0);
    const Direction up = Direction::from({0.0, 0.0, 1.0}), aside = Direction::from({0.3, 0.0, 1.0});
    EXPECT_EQ(kept.scatter.brdf(up, up, aside), given.scatter.brdf(up, up, aside));
    EXPECT_EQ(given.scatter.empty(), std::string(surface).find("0.2") == std::string::npos);
  }
}

TEST(DesignProblem, TheWrittenMirrorHasTheTablesOfTheGivenOne) {
  const TempDir folder;
  write_target(folder.path());
  const auto read = [&](const std::string& text) {
    write_file(folder / "project.toml", text);
    return design_problem(read_project(folder / "project.toml"), folder / "project.toml");
  };
  std::string bare = mirror("family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n");
  const std::string plain = "reflectance = 0.9\n";
  bare.replace(bare.find(plain), plain.size(), "");
  const Direction up = Direction::from({0.0, 0.0, 1.0}), aside = Direction::from({0.3, 0.0, 1.0});
  for (const char* table : {"[reflector.data_sheet]\ntotal = 0.8\ndiffuse = 0.2\n",
                            "[[reflector.scatter]]\nmodel = \"gaussian\"\nshare = 0.2\nsigma = 0.05\n"}) {
    const DesignProblem p = read(kSource + bare + table + "[target]\nfile = \"target.ies\"\n");
    const DesignProblem again = read(project_text(with_shape(p, p.start)));
    const PlacedReflector &given = p.project.scene.reflectors[0], &kept = again.project.scene.reflectors[0];
    EXPECT_FALSE(given.scatter.empty());
    EXPECT_EQ(kept.scatter.brdf(up, up, aside), given.scatter.brdf(up, up, aside));
    EXPECT_EQ(kept.reflectance.at(1.0), given.reflectance.at(1.0));
  }
}

TEST(DesignProblem, RefusesATargetBehindTheMirror) {
  const TempDir folder;
  write_target(folder.path());
  std::string reversed = mirror("family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n");
  reversed.replace(reversed.find("\"-z\""), 4, "\"+z\"");
  const auto file = folder.path() / "project.toml";
  write_file(file, kSource + reversed + "[target]\nfile = \"target.ies\"\n");
  try {
    design_problem(read_project(file), file);
    FAIL() << "taken";
  } catch (const InputError& e) {
    EXPECT_EQ(e.cause(), ErrorCause::contradiction);
    EXPECT_THAT(std::string(e.what()), testing::HasSubstr("180 degrees away from where the mirror opens"));
    EXPECT_THAT(std::string(e.what()), testing::HasSubstr("project.toml: line 18: target: "));
  }
  // With another mirror in the scene the light may be turned around.
  write_file(file,
             kSource + reversed + reversed + "[target]\nfile = \"target.ies\"\n[design]\nreflector = 0\n");
  EXPECT_NO_THROW(static_cast<void>(design_problem(read_project(file), file)));
}

TEST(DesignProblem, NamesWhatIsWrong) {
  const TempDir folder;
  write_target(folder.path());
  const auto message = [&](const std::string& design) {
    try {
      problem(folder.path(), design);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message("optimiser = \"auto\"\n"), testing::HasSubstr("optimizer"));
  EXPECT_THAT(message("optimizer = \"magic\"\n"), testing::HasSubstr("expected auto, least-squares, tree"));
  EXPECT_THAT(message("[design.limits]\nmax_diameter_mm = 50\n"), testing::HasSubstr("60 mm across"));
  EXPECT_THAT(message("[design.limits]\nmin_hole_diameter_mm = 5\n"), testing::HasSubstr("hole_diameter_mm"));
  EXPECT_EQ(message("[design.limits]\nmax_diameter_mm = 60\n"), "");
}

}  // namespace
}  // namespace lucerna
