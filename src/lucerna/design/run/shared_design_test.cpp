// SPDX-License-Identifier: Apache-2.0
// Designs that several processes make together: the bits of one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/design/validation/tolerances.h"
#include "lucerna/photometric_file.h"
#include "tests/support/local_peers.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

class SharedDesign : public testing::Test {
 protected:
  SharedDesign() {
    PhotometricFile spot;
    spot.distribution = uniform_distribution(0.0, 1.0);
    for (std::size_t g = 0; g < spot.distribution.gamma_deg.size(); ++g) {
      const double gamma = spot.distribution.gamma_deg[g];
      spot.distribution.at(0, g) = 1000.0 * std::exp(-gamma * gamma / 200.0);
    }
    write_photometric_file(dir_ / "spot.ldt", spot, PhotometricFormat::ldt);
  }
  DesignProblem problem(const std::string& mirror, const std::string& design) const {
    write_file(dir_ / "p.toml", R"([[source]]
kind = "disk"
radius_mm = 1.0
[[detector]]
kind = "far-field"
c_step_deg = 90.0
gamma_step_deg = 2.0
[target]
file = "spot.ldt"
[[reflector]]
focal_mm = 8
diameter_mm = 60
position_mm = [0, 0, 8]
axis = "-z"
reflectance = 0.9
)" + mirror + "[design]\n" + design);
    return design_problem(read_project(dir_ / "p.toml"), dir_ / "p.toml");
  }
  static DesignOptions few_rays() {
    DesignOptions options;
    options.time_s = 1e6;
    options.max_rays = 1 << 13;
    options.validation_rays = 1 << 15;
    return options;
  }

  /// All that a design finds, as text.
  static std::string text_of(const DesignResult& r) {
    std::string text = r.checkpoint + history_csv(r.history) + std::string(to_string(r.end));
    for (const double x : r.shape.parameters()) text += fmt::format(" {:a}", x);
    for (const DesignError* e : {&r.error, &r.start_error})
      text += fmt::format(" {:a} {:a} {}", e->c48.excess, e->in_rectangle.mean, e->rays);
    text += fmt::format(" {:a} {:a} {:a}", r.efficiency.mean, r.absorbed.mean, r.bound.error);
    for (const std::string& remark : r.remarks) text += remark;
    for (const ParetoPoint& p : r.pareto) text += fmt::format(" {:a}", p.error.c48.excess);
    return text;
  }

  /// What each of `n` processes finds.
  static std::vector<std::string> found_by(int n, const DesignProblem& problem, DesignOptions options) {
    std::vector<std::string> found(static_cast<std::size_t>(n));
    const auto errors = test::on_peers(n, [&](Peers& peers) {
      DesignOptions own = options;
      own.peers = &peers;
      found[static_cast<std::size_t>(peers.rank())] = text_of(design(problem, own));
    });
    for (const std::string& e : errors) EXPECT_EQ(e, "");
    return found;
  }

  test::TempDir dir_;
};

constexpr const char* kSharedRevolution = "family = \"revolution\"\npreset = \"parabola\"\n";
constexpr const char* kSharedFreeForm = "family = \"bspline\"\n";

TEST_F(SharedDesign, HasTheBitsOfOneProcess) {
  const DesignProblem p =
      problem(kSharedRevolution, "intervals = 2\nrestarts = 0\noptimizer = \"least-squares\"\n");
  const std::string alone = text_of(design(p, few_rays()));
  for (const std::string& found : found_by(2, p, few_rays())) EXPECT_EQ(found, alone);
}

using SharedDesignSlow = SharedDesign;

TEST_F(SharedDesignSlow, OfEveryFamilyHasTheBitsOfOneProcess) {
  const std::vector<DesignProblem> problems{
      problem(kSharedRevolution, "intervals = 2\nrestarts = 1\n"),
      problem(kSharedRevolution, "intervals = 1\nrestarts = 0\noptimizer = \"cma-es\"\n"),
      problem(kSharedFreeForm, "intervals = [4, 4]\nrestarts = 1\n"),
      problem(kSharedRevolution, "intervals = 2\nrestarts = 0\n[design.limits]\nmin_efficiency = 0.5\n"),
  };
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const std::string alone = text_of(design(problems[i], few_rays()));
    for (const int n : {1, 2, 3}) {
      for (const std::string& found : found_by(n, problems[i], few_rays()))
        EXPECT_TRUE(found == alone) << "problem " << i << ", " << n << " processes:\n"
                                    << found << "\nalone:\n"
                                    << alone;
    }
  }
}

/// No two processes see the same time: all of them go by the first one's.
TEST_F(SharedDesign, EndsByTheClockOfTheFirstOnAll) {
  const DesignProblem p =
      problem(kSharedRevolution, "intervals = 8\nrestarts = 1000\noptimizer = \"least-squares\"\n");
  std::vector<std::string> found(3);
  const auto errors = test::on_peers(3, [&](Peers& peers) {
    DesignOptions own = few_rays();
    own.peers = &peers;
    own.time_s = 0.5;
    const DesignResult r = design(p, own);
    EXPECT_EQ(r.end, DesignTermination::time);
    found[static_cast<std::size_t>(peers.rank())] = text_of(r);
  });
  for (const std::string& e : errors) EXPECT_EQ(e, "");
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST_F(SharedDesign, TolerancesAreSharedByCase) {
  const DesignProblem p = problem(kSharedRevolution, "intervals = 2\n");
  ToleranceRanges ranges;
  ranges.source_shift_mm = 0.0;
  ranges.source_tilt_deg = 0.0;
  ranges.samples = 3;
  ranges.rays = 1 << 12;
  const std::string alone = tolerances_csv(tolerance_sweep(p.project.scene, ranges, 3));
  for (const int n : {2, 9}) {
    std::mutex one_at_a_time;
    int alike = 0;
    test::on_peers(n, [&](Peers& peers) {
      const std::string csv =
          tolerances_csv(tolerance_sweep(p.project.scene, ranges, 3, no_progress(), &peers));
      const std::lock_guard lock(one_at_a_time);
      alike += csv == alone ? 1 : 0;
    });
    EXPECT_EQ(alike, n);
  }
}

}  // namespace
}  // namespace lucerna
