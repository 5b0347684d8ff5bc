// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/shared_sums.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/design/evaluation/evaluation_sums.h"

namespace lucerna {

namespace {

/// A block of SparseSums on its way.
struct SentBlock {
  std::uint32_t bin, cell;
  SparseSums::Block block;
};

/// Some rows of a sparse matrix, as messages hold them.
struct SentRows {
  std::vector<int> count, column;
  std::vector<double> value, noise;
};

SentRows rows_of(const SparseDerivatives& all, const ItemRange& bins) {
  SentRows rows;
  const SparseJacobian& j = all.rows;
  for (std::size_t b = bins.first; b < bins.last; ++b)
    rows.count.push_back(j.outerIndexPtr()[b + 1] - j.outerIndexPtr()[b]);
  const int first = j.outerIndexPtr()[bins.first], last = j.outerIndexPtr()[bins.last];
  rows.column.assign(j.innerIndexPtr() + first, j.innerIndexPtr() + last);
  rows.value.assign(j.valuePtr() + first, j.valuePtr() + last);
  rows.noise.assign(all.noise.data() + bins.first, all.noise.data() + bins.last);
  return rows;
}

/// The matrix that the rows of all processes make, in their order.
SparseDerivatives joined_rows(const std::vector<SentRows>& all, Eigen::Index bins, Eigen::Index parameters) {
  SparseDerivatives out;
  out.rows.resize(bins, parameters);
  out.noise.resize(bins);
  std::size_t total = 0;
  for (const SentRows& r : all) total += r.column.size();
  out.rows.resizeNonZeros(static_cast<Eigen::Index>(total));
  int at = 0, row = 0;
  for (const SentRows& r : all) {
    LUCERNA_CHECK(row + static_cast<int>(r.count.size()) <= bins, "{} rows after {} of {}", r.count.size(),
                  row, bins);
    std::copy(r.column.begin(), r.column.end(), out.rows.innerIndexPtr() + at);
    std::copy(r.value.begin(), r.value.end(), out.rows.valuePtr() + at);
    for (std::size_t k = 0; k < r.count.size(); ++k) {
      out.noise[row] = r.noise[k];
      out.rows.outerIndexPtr()[row++] = at;
      at += r.count[k];
    }
  }
  out.rows.outerIndexPtr()[row] = at;
  return out;
}

}  // namespace

std::uint64_t state_key(const DesignShape& shape, std::size_t bins, const EvaluationOptions& options) {
  StateKey key;
  key.add(std::uint64_t{bins}).add(options.rays).add(options.derivative_rays).add(options.rim_mm);
  key.add(std::uint64_t{options.derivatives}).add(std::uint64_t{options.direct_light});
  for (const double p : shape.parameters()) key.add(p);
  return key.value();
}

BinJacobian shared_jacobian(Peers& peers, const std::vector<std::vector<double>>& parts, std::size_t bins,
                            const DesignShape& shape, double scale) {
  const std::size_t n = shape.parameter_of().size();
  const ItemRange mine = own_items(&peers, parts.size());
  std::vector<std::string> to(static_cast<std::size_t>(peers.size()));
  for (int r = 0; r < peers.size(); ++r) {
    const ItemRange theirs = items_of(r, peers.size(), bins);
    for (std::size_t p = mine.first; p < mine.last; ++p) {
      to[static_cast<std::size_t>(r)].append(
          reinterpret_cast<const char*>(parts[p].data() + theirs.first * n),
          theirs.size() * n * sizeof(double));
    }
  }
  const std::vector<std::string> from = peers.exchange(to);
  const ItemRange own = own_items(&peers, bins);
  const std::size_t bytes = own.size() * n * sizeof(double);
  std::vector<std::vector<double>> of_own_bins(parts.size(), std::vector<double>(own.size() * n));
  for (int r = 0; r < peers.size(); ++r) {
    const std::string& sent = from[static_cast<std::size_t>(r)];
    const ItemRange theirs = items_of(r, peers.size(), parts.size());
    LUCERNA_CHECK(sent.size() == theirs.size() * bytes, "{} bytes of {} parts", sent.size(), theirs.size());
    for (std::size_t p = theirs.first; p < theirs.last; ++p)
      std::memcpy(of_own_bins[p].data(), sent.data() + (p - theirs.first) * bytes, bytes);
  }
  BinJacobian j(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  j.middleRows(static_cast<Eigen::Index>(own.first), static_cast<Eigen::Index>(own.size())) =
      fold_jacobians(of_own_bins, own.size(), shape, scale);
  const std::size_t row = shape.parameter_count();
  const StateKey key = StateKey().add(std::uint64_t{bins}).add(scale);
  share_items(
      &peers, bins, key.value(),
      [&](std::size_t b, std::string& to_all) {
        to_all.append(reinterpret_cast<const char*>(j.data() + b * row), row * sizeof(double));
      },
      [&](std::size_t b, std::string_view& of_one) {
        LUCERNA_CHECK(of_one.size() >= row * sizeof(double), "{} bytes of a row", of_one.size());
        std::memcpy(j.data() + b * row, of_one.data(), row * sizeof(double));
        of_one.remove_prefix(row * sizeof(double));
      });
  return j;
}

std::vector<SparseSums> exchanged_blocks(Peers& peers, const std::vector<SparseSums>& parts,
                                         std::size_t bins) {
  std::vector<std::string> to(static_cast<std::size_t>(peers.size()));
  std::vector<std::uint32_t> owner(bins);
  for (int r = 0; r < peers.size(); ++r) {
    const ItemRange theirs = items_of(r, peers.size(), bins);
    std::fill(owner.begin() + static_cast<std::ptrdiff_t>(theirs.first),
              owner.begin() + static_cast<std::ptrdiff_t>(theirs.last), static_cast<std::uint32_t>(r));
  }
  const ItemRange mine = own_items(&peers, parts.size());
  for (std::size_t p = mine.first; p < mine.last; ++p) {
    std::vector<std::vector<SentBlock>> sent(to.size());
    for (std::size_t i = 0; i < parts[p].size(); ++i)
      sent[owner[parts[p].bin(i)]].push_back({parts[p].bin(i), parts[p].cell(i), parts[p].at(i)});
    for (std::size_t r = 0; r < to.size(); ++r) append(to[r], sent[r]);
  }
  const std::vector<std::string> from = peers.exchange(to);
  std::vector<SparseSums> out = sparse_sums(parts.size(), parts.front().cells());
  for (int r = 0; r < peers.size(); ++r) {
    std::string_view bytes = from[static_cast<std::size_t>(r)];
    const ItemRange theirs = items_of(r, peers.size(), parts.size());
    for (std::size_t p = theirs.first; p < theirs.last; ++p) {
      std::vector<SentBlock> blocks;
      take(bytes, blocks);
      for (const SentBlock& b : blocks) out[p].add(b.bin, b.cell, b.block);
      out[p].settle();
    }
  }
  return out;
}

void share_rows(Peers& peers, SparseDerivatives& derivatives) {
  const auto bins = static_cast<std::size_t>(derivatives.rows.rows());
  std::vector<SentRows> all(static_cast<std::size_t>(peers.size()));
  const auto own = static_cast<std::size_t>(peers.rank());
  all[own] = rows_of(derivatives, own_items(&peers, bins));
  share_items(
      &peers, all.size(), StateKey().add(std::uint64_t{bins}).value(),
      [&](std::size_t r, std::string& bytes) {
        append(bytes, all[r].count);
        append(bytes, all[r].column);
        append(bytes, all[r].value);
        append(bytes, all[r].noise);
      },
      [&](std::size_t r, std::string_view& bytes) {
        take(bytes, all[r].count);
        take(bytes, all[r].column);
        take(bytes, all[r].value);
        take(bytes, all[r].noise);
      });
  derivatives = joined_rows(all, derivatives.rows.rows(), derivatives.rows.cols());
}

}  // namespace lucerna
