// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// Bins by parameters; a row holds the parameters that move the bin's light.
using SparseJacobian = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Derivatives of bins by the coefficients of a bicubic spline, gathered ray by ray. A hit in a cell of knots
/// moves sixteen coefficients, so what is kept are blocks of sixteen: one for each pair of a bin and a cell
/// that light connects. Of a free form and fine bins these are one or two in a hundred of all pairs.
class SparseSums {
 public:
  using Block = std::array<double, 16>;

  /// `cells`: cells of knots, numbered from 0.
  explicit SparseSums(std::uint32_t cells) : cells_(cells) {}

  /// The block of a bin and a cell, zero at first. Valid until the next call.
  Block& block(std::uint32_t bin, std::uint32_t cell) {
    const std::uint64_t key = std::uint64_t{bin} * cells_ + cell;
    std::size_t at = slot(key);
    while (table_[at] != kEmpty) {
      if (keys_[table_[at]] == key) return block_at(table_[at]);
      at = (at + 1) & mask_;
    }
    return insert(key, at);
  }

  std::uint32_t cells() const { return cells_; }
  std::size_t size() const { return keys_.size(); }
  std::uint32_t bin(std::size_t i) const { return static_cast<std::uint32_t>(keys_[i] / cells_); }
  std::uint32_t cell(std::size_t i) const { return static_cast<std::uint32_t>(keys_[i] % cells_); }
  const Block& at(std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

 private:
  /// Blocks that are allocated together; they never move, for there are many and they are wide.
  static constexpr std::size_t kChunk = 256;
  static constexpr std::uint32_t kEmpty = ~std::uint32_t{0};

  std::size_t slot(std::uint64_t key) const { return (key * 0x9E3779B97F4A7C15ull >> 32) & mask_; }
  Block& block_at(std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  Block& insert(std::uint64_t key, std::size_t at);
  void grow();

  std::uint32_t cells_;
  std::size_t mask_ = (std::size_t{1} << 12) - 1;
  std::vector<std::uint32_t> table_ = std::vector<std::uint32_t>(std::size_t{1} << 12, kEmpty);
  std::vector<std::uint64_t> keys_;
  std::vector<std::vector<Block>> chunks_;
};

/// The derivatives that rays add up to, and how well these rays know them.
struct SparseDerivatives {
  SparseJacobian rows;
  /// For each bin what the scatter of the rays adds, in the mean, to the squared length of its row: from the
  /// scatter of the parts.
  Eigen::VectorXd noise;
};

/// Adds sums in their order, times `scale`, and the coefficients of `shape` (a free form) that are one
/// parameter. At least two parts, of equally many independent rays each. The same bits for any number of
/// threads.
SparseDerivatives sparse_derivatives(const std::vector<SparseSums>& parts, std::size_t bins,
                                     const DesignShape& shape, double scale);

}  // namespace lucerna
