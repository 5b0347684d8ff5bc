// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/sparse_jacobian.h"

#include <algorithm>
#include <numeric>
#include <variant>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

SparseSums::Block& SparseSums::insert(std::uint64_t key, std::size_t at) {
  if (2 * (keys_.size() + 1) > table_.size()) {
    grow();
    at = slot(key);
    while (table_[at] != kEmpty) at = (at + 1) & mask_;
  }
  table_[at] = static_cast<std::uint32_t>(keys_.size());
  keys_.push_back(key);
  return blocks_.emplace_back(Block{});
}

void SparseSums::grow() {
  const std::size_t size = 4 * table_.size();
  table_.assign(size, kEmpty);
  mask_ = size - 1;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    std::size_t at = slot(keys_[i]);
    while (table_[at] != kEmpty) at = (at + 1) & mask_;
    table_[at] = static_cast<std::uint32_t>(i);
  }
}

namespace {

/// Where a block is: which sums, and its number there.
struct BlockPlace {
  std::uint32_t part, number;
};

/// The blocks of each bin, in the order of the parts: those of bin b are [begin[b], begin[b + 1]).
struct BlocksByBin {
  std::vector<std::size_t> begin;
  std::vector<BlockPlace> place;
};

BlocksByBin by_bin(const std::vector<SparseSums>& parts, std::size_t bins) {
  BlocksByBin out;
  out.begin.assign(bins + 1, 0);
  for (const SparseSums& p : parts) {
    for (std::size_t i = 0; i < p.size(); ++i) ++out.begin[p.bin(i) + 1];
  }
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.place.resize(out.begin.back());
  std::vector<std::size_t> next(out.begin.begin(), out.begin.end() - 1);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (std::size_t i = 0; i < parts[part].size(); ++i) {
      out.place[next[parts[part].bin(i)]++] = {static_cast<std::uint32_t>(part),
                                               static_cast<std::uint32_t>(i)};
    }
  }
  return out;
}

/// Some rows of the Jacobian.
struct SparseRows {
  std::vector<int> count, column;
  std::vector<double> value;
};

}  // namespace

SparseJacobian sparse_jacobian(const std::vector<SparseSums>& parts, std::size_t bins,
                               const DesignShape& shape, double scale) {
  const auto& spline = std::get<BsplineShape>(shape.family());
  const auto across = static_cast<std::uint32_t>(spline.row_x().intervals);
  const int stride = spline.row_x().coefficients();
  const std::vector<int>& parameter_of = shape.parameter_of();
  const BlocksByBin blocks = by_bin(parts, bins);

  const auto rows_of = [&](std::size_t first, std::size_t last) {
    SparseRows rows;
    std::vector<double> sum(shape.parameter_count(), 0.0);
    std::vector<char> seen(shape.parameter_count(), 0);
    std::vector<int> touched;
    for (std::size_t b = first; b < last; ++b) {
      touched.clear();
      for (std::size_t k = blocks.begin[b]; k < blocks.begin[b + 1]; ++k) {
        const SparseSums& part = parts[blocks.place[k].part];
        const std::uint32_t cell = part.cell(blocks.place[k].number);
        const SparseSums::Block& block = part.at(blocks.place[k].number);
        const int corner = static_cast<int>(cell / across) * stride + static_cast<int>(cell % across);
        for (int i = 0; i < 16; ++i) {
          const int p = parameter_of[static_cast<std::size_t>(corner + (i / 4) * stride + i % 4)];
          if (seen[static_cast<std::size_t>(p)] == 0) {
            seen[static_cast<std::size_t>(p)] = 1;
            touched.push_back(p);
          }
          sum[static_cast<std::size_t>(p)] += block[static_cast<std::size_t>(i)];
        }
      }
      std::sort(touched.begin(), touched.end());
      rows.count.push_back(static_cast<int>(touched.size()));
      for (const int p : touched) {
        rows.column.push_back(p);
        rows.value.push_back(scale * sum[static_cast<std::size_t>(p)]);
        sum[static_cast<std::size_t>(p)] = 0.0;
        seen[static_cast<std::size_t>(p)] = 0;
      }
    }
    return rows;
  };
  const std::vector<SparseRows> all = parallel_map_blocks<SparseRows>(bins, 256, rows_of);

  SparseJacobian j(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  std::size_t total = 0;
  for (const SparseRows& r : all) total += r.column.size();
  j.resizeNonZeros(static_cast<Eigen::Index>(total));
  int at = 0, row = 0;
  for (const SparseRows& r : all) {
    std::copy(r.column.begin(), r.column.end(), j.innerIndexPtr() + at);
    std::copy(r.value.begin(), r.value.end(), j.valuePtr() + at);
    for (const int n : r.count) {
      j.outerIndexPtr()[row++] = at;
      at += n;
    }
  }
  j.outerIndexPtr()[row] = at;
  return j;
}

}  // namespace lucerna
