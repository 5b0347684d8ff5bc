// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/sparse_jacobian.h"

#include <algorithm>
#include <numeric>
#include <variant>

#include "lucerna/core/cpu/huge_pages.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

std::vector<SparseSums> sparse_sums(std::size_t count, std::uint32_t cells) {
  std::vector<SparseSums> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(cells);
  return out;
}

void SparseSums::settle() {
  for (std::size_t i = 0; i < kWaiting; ++i) {
    Waiting& w = waiting_[added_++ % kWaiting];
    if (w.block == nullptr) find(w);
    settle(w);
  }
}

bool SparseSums::is_settled() const {
  return std::all_of(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return w.key == kNone; });
}

SparseSums::Block& SparseSums::insert(std::uint64_t key, std::size_t at) {
  if (2 * (keys_.size() + 1) > table_.size()) {
    grow();
    at = slot(key);
    while (table_[at].key != kNone) at = (at + 1) & mask_;
  }
  if (keys_.size() % kChunk == 0) {
    chunks_.emplace_back().reserve(kChunk);
    advise_huge_pages(chunks_.back().data(), kChunk * sizeof(Block));
  }
  keys_.push_back(key);
  Block& block = chunks_.back().emplace_back(Block{});
  table_[at] = {key, &block};
  return block;
}

void SparseSums::grow() {
  std::vector<Slot> old;
  old.swap(table_);
  table_.reserve(4 * old.size());
  advise_huge_pages(table_.data(), table_.capacity() * sizeof(Slot));
  table_.resize(4 * old.size());
  mask_ = table_.size() - 1;
  for (const Slot& s : old) {
    if (s.key == kNone) continue;
    std::size_t at = slot(s.key);
    while (table_[at].key != kNone) at = (at + 1) & mask_;
    table_[at] = s;
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
    LUCERNA_CHECK(p.is_settled(), "of {} blocks some are not whole", p.size());
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

/// The blocks of a bin lie anywhere: each is asked for while so many before it are added.
constexpr std::size_t kAhead = 12;
void prefetch(const SparseSums::Block& block) {
  __builtin_prefetch(block.data());
  __builtin_prefetch(block.data() + 8);
}

/// Some rows of the Jacobian, and what noise adds to the square of each.
struct SparseRows {
  std::vector<int> count, column;
  std::vector<double> value, noise;
};

/// One row, parameter by parameter, of parts that are added one after the other.
class RowSums {
 public:
  explicit RowSums(std::size_t parameters)
      : total_(parameters, 0.0), part_(parameters, 0.0), seen_(parameters, 0) {}

  void add(int parameter, double value) {
    const auto p = static_cast<std::size_t>(parameter);
    if (seen_[p] == 0) {
      seen_[p] = 1;
      touched_.push_back(parameter);
    }
    if (part_[p] == 0.0) of_part_.push_back(parameter);
    part_[p] += value;
  }

  void end_part() {
    for (const int parameter : of_part_) {
      double& sum = part_[static_cast<std::size_t>(parameter)];
      total_[static_cast<std::size_t>(parameter)] += sum;
      squares_ += sum * sum;
      sum = 0.0;
    }
    of_part_.clear();
  }

  /// The row times `scale`, with its noise if there were `parts` parts; then all is zero again.
  void take(SparseRows& out, double scale, double parts) {
    std::sort(touched_.begin(), touched_.end());
    out.count.push_back(static_cast<int>(touched_.size()));
    double squared = 0.0;
    for (const int parameter : touched_) {
      double& sum = total_[static_cast<std::size_t>(parameter)];
      out.column.push_back(parameter);
      out.value.push_back(scale * sum);
      squared += sum * sum;
      sum = 0.0;
      seen_[static_cast<std::size_t>(parameter)] = 0;
    }
    out.noise.push_back(scale * scale * (parts * squares_ - squared) / (parts - 1.0));
    touched_.clear();
    squares_ = 0.0;
  }

 private:
  std::vector<double> total_, part_;
  std::vector<char> seen_;
  std::vector<int> touched_, of_part_;
  double squares_ = 0.0;
};

}  // namespace

SparseDerivatives sparse_derivatives(const std::vector<SparseSums>& parts, std::size_t bins,
                                     const DesignShape& shape, double scale) {
  const auto& spline = std::get<BsplineShape>(shape.family());
  const auto across = static_cast<std::uint32_t>(spline.row_x().intervals);
  const int stride = spline.row_x().coefficients();
  const std::vector<int>& parameter_of = shape.parameter_of();
  const BlocksByBin blocks = by_bin(parts, bins);

  const auto rows_of = [&](std::size_t first, std::size_t last) {
    SparseRows rows;
    RowSums sums(shape.parameter_count());
    for (std::size_t b = first; b < last; ++b) {
      for (std::size_t k = blocks.begin[b]; k < blocks.begin[b + 1]; ++k) {
        if (k + kAhead < blocks.place.size()) {
          const BlockPlace& soon = blocks.place[k + kAhead];
          prefetch(parts[soon.part].at(soon.number));
        }
        const BlockPlace& place = blocks.place[k];
        const std::uint32_t cell = parts[place.part].cell(place.number);
        const SparseSums::Block& block = parts[place.part].at(place.number);
        const int corner = static_cast<int>(cell / across) * stride + static_cast<int>(cell % across);
        for (int i = 0; i < 16; ++i) {
          const int c = corner + (i / 4) * stride + i % 4;
          sums.add(parameter_of[static_cast<std::size_t>(c)], block[static_cast<std::size_t>(i)]);
        }
        if (k + 1 == blocks.begin[b + 1] || blocks.place[k + 1].part != place.part) sums.end_part();
      }
      sums.take(rows, scale, static_cast<double>(parts.size()));
    }
    return rows;
  };
  const std::vector<SparseRows> all = parallel_map_blocks<SparseRows>(bins, 256, rows_of);

  SparseDerivatives out;
  SparseJacobian& j = out.rows;
  j.resize(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  out.noise.resize(static_cast<Eigen::Index>(bins));
  std::size_t total = 0;
  for (const SparseRows& r : all) total += r.column.size();
  j.resizeNonZeros(static_cast<Eigen::Index>(total));
  int at = 0, row = 0;
  for (const SparseRows& r : all) {
    std::copy(r.column.begin(), r.column.end(), j.innerIndexPtr() + at);
    std::copy(r.value.begin(), r.value.end(), j.valuePtr() + at);
    for (std::size_t k = 0; k < r.count.size(); ++k) {
      out.noise[row] = r.noise[k];
      j.outerIndexPtr()[row++] = at;
      at += r.count[k];
    }
  }
  j.outerIndexPtr()[row] = at;
  return out;
}

}  // namespace lucerna
