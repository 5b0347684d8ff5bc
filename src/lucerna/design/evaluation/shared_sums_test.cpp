// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/shared_sums.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "tests/support/local_peers.h"

namespace lucerna {
namespace {

DesignRays lamp_rays(std::uint64_t n) {
  DesignRays rays({{make_emitter({.kind = EmitterKind::cylinder}),
                    Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15}),
                    {}}},
                  Frame(), 7);
  rays.grow(n);
  return rays;
}

DesignShape uneven(const DesignShape& shape) {
  Eigen::VectorXd p = shape.parameters();
  Rng rng(3, 0);
  for (double& x : p) x += 0.5 * (2.0 * rng.uniform() - 1.0);
  return shape.with(p);
}

struct SharedCase {
  const char* name;
  DesignShape shape;
  TentBins bins;
  bool sparse;
};

std::vector<SharedCase> shared_cases() {
  const Aperture square = Aperture::rectangle(100, 100, 8);
  const DesignShape free_form = uneven(DesignShape::bspline(15, square, 6, 5, ShapeSymmetry::both));
  return {
      {"revolution", uneven(DesignShape::revolution(15, Aperture::circle(100), 8)),
       TentBins::rings(Frame(), 0.5, 20), false},
      {"free form", free_form, TentBins::square(Frame(), 0.4, 24), false},
      {"free form, sparse", free_form, TentBins::square(Frame(), 0.4, 24), true},
  };
}

/// Every number of the two.
bool same_bits(const Evaluation& a, const Evaluation& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.rows() == y.rows() && x.cols() == y.cols() && (x.array() == y.array()).all();
  };
  const bool rows = a.rows.rows() == b.rows.rows() && a.rows.nonZeros() == b.rows.nonZeros() &&
                    (a.rows.rows() == 0 || (a.rows.toDense().array() == b.rows.toDense().array()).all());
  return rows && same(a.flux, b.flux) && same(a.variance, b.variance) && same(a.jacobian, b.jacobian) &&
         same(a.rows_noise, b.rows_noise) && a.reflected == b.reflected && a.direct == b.direct &&
         a.absorbed == b.absorbed && a.back == b.back && a.lost == b.lost && a.bodies == b.bodies &&
         a.rays == b.rays;
}

/// Evaluates on so many peers; how many of them have `alone` to the bit.
int peers_alike(int n, const SharedCase& c, const DesignRays& rays, const EvaluationOptions& options,
                const Evaluation& alone) {
  std::mutex one_at_a_time;
  int alike = 0;
  const auto errors = test::on_peers(n, [&](Peers& peers) {
    DesignRays shared = rays;
    shared.share_with(&peers);
    const Evaluation e = evaluate(c.shape, Reflectance(0.9), shared, c.bins, options);
    const std::lock_guard lock(one_at_a_time);
    alike += same_bits(e, alone) ? 1 : 0;
  });
  for (const std::string& e : errors) EXPECT_EQ(e, "") << c.name;
  return alike;
}

TEST(SharedEvaluation, HasTheBitsOfOneProcess) {
  const DesignRays rays = lamp_rays(1 << 14);
  for (const SharedCase& c : shared_cases()) {
    for (const bool derivatives : {true, false}) {
      EvaluationOptions options;
      options.rays = 1 << 14;
      options.rim_mm = 1.0;
      options.derivatives = derivatives;
      options.sparse = c.sparse && derivatives;
      const Evaluation alone = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
      ASSERT_TRUE(same_bits(alone, alone));
      for (const int n : {1, 2, 3, 5, 17})
        EXPECT_EQ(peers_alike(n, c, rays, options, alone), n) << c.name << ", derivatives " << derivatives;
    }
  }
}

TEST(SharedEvaluation, AlsoWithMorePartsThanPeers) {
  const std::uint64_t n = 1 << 19;
  const DesignRays rays = lamp_rays(n);
  const SharedCase c = shared_cases().back();
  EvaluationOptions options;
  options.rays = n;
  options.sparse = true;
  const Evaluation alone = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
  EXPECT_EQ(peers_alike(3, c, rays, options, alone), 3);
  options.derivative_rays = n / 2;
  const Evaluation half = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
  EXPECT_EQ(peers_alike(3, c, rays, options, half), 3);
  EXPECT_EQ(peers_alike(3, c, rays, options, alone), 0) << "derivatives of half the rays are others";
  options.derivative_rays = 0;
  // The order of the parts is in the bits: the check can tell.
  options.rays = n / 2;
  EXPECT_EQ(peers_alike(3, c, rays, options, alone), 0);
}

TEST(SharedEvaluation, APeerWithAnotherShapeIsFoundByAll) {
  const DesignRays rays = lamp_rays(1 << 13);
  const SharedCase c = shared_cases().front();
  const auto errors = test::on_peers(3, [&](Peers& peers) {
    DesignRays shared = rays;
    shared.share_with(&peers);
    EvaluationOptions options;
    options.rays = 1 << 13;
    Eigen::VectorXd p = c.shape.parameters();
    if (peers.rank() == 1) p[2] = std::nextafter(p[2], 1e9);
    evaluate(c.shape.with(p), Reflectance(0.9), shared, c.bins, options);
  });
  for (const std::string& e : errors)
    EXPECT_THAT(e, testing::HasSubstr("process 1 no longer has the numbers"));
}

}  // namespace
}  // namespace lucerna
