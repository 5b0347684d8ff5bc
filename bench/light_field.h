// SPDX-License-Identifier: Apache-2.0
// The plain baseline of a source model: a uniform four-dimensional table of radiance over the bounding
// surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/charts/support.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/alias_table.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna::bench {

/// Cells of equal étendue, `cells` along each of the four numbers of a Support on the surface where the rays
/// start, in the box that holds all of them; a byte a cell on a logarithmic scale (steps of 4.4 %).
class LightField final : public RaySource {
 public:
  LightField(const RayBlock& rays, std::size_t cells) : n_(cells) {
    const BoundingSurface surface = starting_surface(rays);
    const auto found = support_on(surface, PolarMap::concentric);
    if (!found) throw InputError("a light field needs a surface that the rays start on");
    support_ = *found;
    charts_.resize(support_.charts());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (const auto p = support_.to_chart(rays.ray(i))) charts_[p->chart].hold(p->c);
    }
    for (Chart& chart : charts_) chart.weight.assign(n_ * n_ * n_ * n_, 0.0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto p = support_.to_chart(rays.ray(i));
      if (p) charts_[p->chart].weight[cell(charts_[p->chart], p->c)] += static_cast<double>(rays.weight[i]);
    }
    round_to_bytes();
    std::vector<double> all;
    for (const Chart& chart : charts_) all.insert(all.end(), chart.weight.begin(), chart.weight.end());
    table_ = AliasTable(all);
  }

  double flux() const override { return 1.0; }
  FluxUnit flux_unit() const override { return FluxUnit::lumen; }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override {
    const std::size_t per_chart = n_ * n_ * n_ * n_;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto u = sequence.point<5>(first + i);
      std::size_t k = table_.pick(u[4]);
      ChartPoint p{static_cast<std::uint32_t>(k / per_chart), {}};
      const Chart& chart = charts_[p.chart];
      k %= per_chart;
      for (std::size_t d = 4; d-- > 0; k /= n_) {
        const double t = (static_cast<double>(k % n_) + u[d]) / static_cast<double>(n_);
        p.c[d] = chart.low[d] + t * (chart.high[d] - chart.low[d]);
      }
      out.set(i, support_.from_chart(p));
      out.weight[i] = 1.0f;
    }
  }

  /// The table as floats, and as a file of bytes packed by zstd.
  std::uint64_t table_bytes() const { return 4 * charts_.size() * n_ * n_ * n_ * n_; }
  std::uint64_t packed_bytes() const { return packed_; }

 private:
  struct Chart {
    std::array<double, 4> low{1e300, 1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300, -1e300};
    std::vector<double> weight;
    void hold(const std::array<double, 4>& c) {
      for (std::size_t d = 0; d < 4; ++d) {
        low[d] = std::min(low[d], c[d]);
        high[d] = std::max(high[d], c[d]);
      }
    }
  };

  std::size_t cell(const Chart& chart, const std::array<double, 4>& c) const {
    std::size_t index = 0;
    for (std::size_t d = 0; d < 4; ++d) {
      const double t = (c[d] - chart.low[d]) / std::max(1e-300, chart.high[d] - chart.low[d]);
      index = index * n_ + std::min(n_ - 1, static_cast<std::size_t>(t * static_cast<double>(n_)));
    }
    return index;
  }

  void round_to_bytes() {
    double max = 0.0;
    for (const Chart& chart : charts_)
      max = std::max(max, *std::max_element(chart.weight.begin(), chart.weight.end()));
    std::string bytes;
    for (Chart& chart : charts_) {
      for (double& w : chart.weight) {
        const double level = w > 0.0 ? std::max(1.0, 255.0 + std::round(16.0 * std::log2(w / max))) : 0.0;
        bytes.push_back(static_cast<char>(static_cast<std::uint8_t>(level)));
        w = level > 0.0 ? std::exp2((level - 255.0) / 16.0) : 0.0;
      }
    }
    NflFile file;
    file.add({'L', 'F', 'L', 'D'}, std::move(bytes));
    packed_ = encode_nfl(file).size();
  }

  std::size_t n_;
  Support support_;
  std::vector<Chart> charts_;
  AliasTable table_;
  std::uint64_t packed_ = 0;
};

}  // namespace lucerna::bench
