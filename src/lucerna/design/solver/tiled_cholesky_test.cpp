// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/tiled_cholesky.h"

#include <gtest/gtest.h>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Lower triangle of B B^T + I, with what may be anything above it.
Eigen::MatrixXd definite(Eigen::Index n) {
  Rng rng(3, static_cast<std::uint64_t>(n));
  Eigen::MatrixXd b(n, n);
  for (double& x : b.reshaped()) x = rng.uniform() - 0.5;
  const Eigen::MatrixXd all = b * b.transpose() + Eigen::MatrixXd::Identity(n, n);
  return Eigen::MatrixXd(all.triangularView<Eigen::Lower>()) +
         7.0 * Eigen::MatrixXd(Eigen::MatrixXd::Ones(n, n).triangularView<Eigen::StrictlyUpper>());
}

TEST(TiledCholesky, SolvesForAnyNumberOfRows) {
  for (const Eigen::Index n : {1, 5, 127, 128, 129, 256, 300}) {
    const Eigen::MatrixXd a = definite(n).selfadjointView<Eigen::Lower>();
    Eigen::MatrixXd l = definite(n), x = Eigen::MatrixXd::Ones(n, 2);
    x.col(1).setLinSpaced(-1.0, 2.0);
    const Eigen::MatrixXd right = x;
    ASSERT_TRUE(factorise_in_tiles(l)) << n;
    solve_factorised(l, x);
    EXPECT_LT((a * x - right).cwiseAbs().maxCoeff(), 1e-11 * static_cast<double>(n)) << n;
  }
}

TEST(TiledCholesky, RefusesWhatIsNotPositiveDefinite) {
  for (const Eigen::Index at : {0, 130, 299}) {
    Eigen::MatrixXd a = definite(300);
    a(at, at) = -1.0;
    EXPECT_FALSE(factorise_in_tiles(a)) << at;
  }
}

TEST(TiledCholesky, SameBitsForAnyNumberOfThreads) {
  Eigen::MatrixXd one = definite(400), more = one;
  ASSERT_TRUE(factorise_in_tiles(more));
  const ThreadLimit limit(1);
  ASSERT_TRUE(factorise_in_tiles(one));
  EXPECT_EQ(Eigen::MatrixXd(one.triangularView<Eigen::Lower>()),
            Eigen::MatrixXd(more.triangularView<Eigen::Lower>()));
}

}  // namespace
}  // namespace lucerna
