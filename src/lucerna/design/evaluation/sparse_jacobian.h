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
/// that light connects. Of a free form and fine bins these are one or two in a hundred of all pairs: hundreds
/// of thousands, far more than caches hold, and each ray adds to others. So what is added waits until its
/// block has come from memory.
class SparseSums {
 public:
  using Block = std::array<double, 16>;

  /// `cells`: cells of knots, numbered from 0.
  explicit SparseSums(std::uint32_t cells) : cells_(cells) {}
  /// Places point into the blocks.
  SparseSums(const SparseSums&) = delete;
  SparseSums& operator=(const SparseSums&) = delete;
  SparseSums(SparseSums&&) = default;
  SparseSums& operator=(SparseSums&&) = default;
  ~SparseSums() = default;

  /// Adds to the block of a bin and a cell, zero at first.
  void add(std::uint32_t bin, std::uint32_t cell, const Block& values) {
    find(waiting_[(added_ + kWaiting / 2) % kWaiting]);
    Waiting& oldest = waiting_[added_++ % kWaiting];
    settle(oldest);
    oldest.key = std::uint64_t{bin} * cells_ + cell;
    oldest.values = values;
    __builtin_prefetch(&table_[slot(oldest.key)]);
  }
  /// To be called when all is added, before anything is read: what still waits is not in the blocks.
  void settle();
  bool is_settled() const;

  std::uint32_t cells() const { return cells_; }
  std::size_t size() const { return keys_.size(); }
  std::uint32_t bin(std::size_t i) const { return static_cast<std::uint32_t>(keys_[i] / cells_); }
  std::uint32_t cell(std::size_t i) const { return static_cast<std::uint32_t>(keys_[i] % cells_); }
  const Block& at(std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

 private:
  /// Blocks that are allocated together, on large pages of memory; they never move.
  static constexpr std::size_t kChunk = std::size_t{1} << 16;
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  /// Halfway through its wait a block's place is known, and the block is asked for.
  static constexpr std::size_t kWaiting = 32;

  struct Slot {
    std::uint64_t key = kNone;
    Block* block = nullptr;
  };
  struct Waiting {
    std::uint64_t key = kNone;
    Block* block = nullptr;
    Block values;
  };

  std::size_t slot(std::uint64_t key) const { return (key * 0x9E3779B97F4A7C15ull >> 32) & mask_; }
  Block& block_of(std::uint64_t key) {
    std::size_t at = slot(key);
    for (; table_[at].key != kNone; at = (at + 1) & mask_) {
      if (table_[at].key == key) return *table_[at].block;
    }
    return insert(key, at);
  }
  void find(Waiting& w) {
    if (w.key == kNone) return;
    w.block = &block_of(w.key);
    __builtin_prefetch(w.block->data(), 1);
    __builtin_prefetch(w.block->data() + 8, 1);
  }
  static void settle(Waiting& w) {
    if (w.block == nullptr) return;
    for (std::size_t k = 0; k < w.values.size(); ++k) (*w.block)[k] += w.values[k];
    w.key = kNone;
    w.block = nullptr;
  }
  Block& insert(std::uint64_t key, std::size_t at);
  void grow();

  std::uint32_t cells_;
  std::size_t mask_ = (std::size_t{1} << 12) - 1;
  std::vector<Slot> table_ = std::vector<Slot>(std::size_t{1} << 12);
  std::vector<std::uint64_t> keys_;
  std::vector<std::vector<Block>> chunks_;
  std::array<Waiting, kWaiting> waiting_;
  std::size_t added_ = 0;
};

/// So many, for the same number of cells.
std::vector<SparseSums> sparse_sums(std::size_t count, std::uint32_t cells);

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
