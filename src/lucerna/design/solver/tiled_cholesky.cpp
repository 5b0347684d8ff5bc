// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/tiled_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Two tiles fit the cache of a core, and a matrix of a thousand rows has enough of them for many threads.
constexpr Eigen::Index kTile = 128;

/// The rows or columns of one tile.
struct Span {
  Eigen::Index first, size;
};

}  // namespace

bool factorise_in_tiles(Eigen::MatrixXd& a) {
  const Eigen::Index n = a.rows(), tiles = (n + kTile - 1) / kTile;
  const auto span = [&](Eigen::Index t) { return Span{t * kTile, std::min(kTile, n - t * kTile)}; };
  const auto tile = [&](Eigen::Index i, Eigen::Index j) {
    const Span rows = span(i), columns = span(j);
    return a.block(rows.first, columns.first, rows.size, columns.size);
  };
  for (Eigen::Index k = 0; k < tiles; ++k) {
    auto corner = tile(k, k);
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> own(corner);
    if (own.info() != Eigen::Success) return false;
    std::vector<std::pair<Eigen::Index, Eigen::Index>> rest;
    for (Eigen::Index j = k + 1; j < tiles; ++j) {
      for (Eigen::Index i = j; i < tiles; ++i) rest.emplace_back(i, j);
    }
    parallel_blocks(static_cast<std::size_t>(tiles - k - 1), 1, [&](std::size_t i, std::size_t) {
      auto below = tile(k + 1 + static_cast<Eigen::Index>(i), k);
      corner.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    });
    parallel_blocks(rest.size(), 1, [&](std::size_t t, std::size_t) {
      const auto [i, j] = rest[t];
      tile(i, j).noalias() -= tile(i, k) * tile(j, k).transpose();
    });
  }
  return true;
}

void solve_factorised(const Eigen::MatrixXd& l, Eigen::MatrixXd& right) {
  l.triangularView<Eigen::Lower>().solveInPlace(right);
  l.triangularView<Eigen::Lower>().transpose().solveInPlace(right);
}

}  // namespace lucerna
