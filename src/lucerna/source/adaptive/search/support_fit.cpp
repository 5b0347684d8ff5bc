// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_fit.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/charts/chart_batch.h"

namespace lucerna {

namespace {

constexpr std::size_t kFitBlock = 1 << 14, kBoundingRays = 8192;
constexpr double kOpen = 1e29, kTail = 0.002, kDirectionTolerance = 1e-6;
constexpr std::uint8_t kMissedChart = 255, kWithoutFlux = 254;

bool inside(const TreeBox& box, const std::array<double, 4>& c) {
  bool in = true;
  for (std::size_t d = 0; d < 4; ++d) in = in && c[d] >= box.low[d] && c[d] <= box.high[d];
  return in;
}

/// The item and chart of every ray.
void project_all(const RayBlock& rays, std::span<const float> weight, const BoundedSupport& on,
                 std::vector<TreeItem>& items, std::vector<std::uint8_t>& chart) {
  parallel_blocks(rays.size(), kFitBlock, [&](std::size_t first, std::size_t last) {
    RayBatch batch;
    ChartBatch lines;
    for (std::size_t at = first; at < last; at += kSupportBatch) {
      const std::size_t n = std::min(kSupportBatch, last - at);
      load_batch(rays, at, 1, n, batch);
      charts_of(on.support, batch, lines);
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = at + k;
        chart[i] = weight[i] > 0.0f ? kMissedChart : kWithoutFlux;
        const std::uint8_t its = lines.chart[k];
        if (chart[i] != kMissedChart || its == kNoChart || !inside(on.limits[its], lines.point(k))) continue;
        chart[i] = its;
        for (std::size_t d = 0; d < 4; ++d) items[i].c[d] = static_cast<float>(lines.c[d][k]);
        items[i].weight = weight[i];
      }
    }
  });
}

void close_box(ChartItems& c, const Support& support, double tolerance_mm) {
  c.box.low.fill(1e300);
  c.box.high.fill(-1e300);
  for (const TreeItem& item : c.items) {
    c.weight += static_cast<double>(item.weight);
    for (std::size_t d = 0; d < 4; ++d) {
      c.box.low[d] = std::min(c.box.low[d], static_cast<double>(item.c[d]));
      c.box.high[d] = std::max(c.box.high[d], static_cast<double>(item.c[d]));
    }
  }
  for (std::size_t d = 0; d < 4; ++d) {
    const double tolerance = d < 2 ? tolerance_mm : kDirectionTolerance;
    if (c.box.width(d) <= tolerance) {
      c.box.low[d] = c.box.high[d] = 0.5 * (c.box.low[d] + c.box.high[d]);
      continue;
    }
    // Natural ends that the rays reach to within a few parts in a thousand are the true ones.
    const auto range = support.range(c.chart, d);
    const double near = 0.002 * c.box.width(d);
    if (c.box.low[d] - range[0] < near) c.box.low[d] = range[0];
    if (range[1] - c.box.high[d] < near) c.box.high[d] = range[1];
  }
}

/// The kTail and 1 - kTail quantiles.
std::array<double, 2> core_of(std::vector<double>& v) {
  const auto tail = static_cast<std::ptrdiff_t>(kTail * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + tail, v.end());
  const double low = v[static_cast<std::size_t>(tail)];
  std::nth_element(v.begin(), v.end() - 1 - tail, v.end());
  return {low, *(v.end() - 1 - tail)};
}

}  // namespace

BoundedSupport bounded(const Support& support, const RayBlock& rays) {
  BoundedSupport result{support, std::vector<TreeBox>(support.charts())};
  std::vector<std::array<std::vector<double>, 2>> values(support.charts());
  const std::size_t stride = 1 + rays.size() / kBoundingRays;
  RayBatch batch;
  ChartBatch lines;
  for (std::size_t first = 0; first < rays.size(); first += stride * kSupportBatch) {
    const std::size_t n = std::min(kSupportBatch, block_count(rays.size() - first, stride));
    load_batch(rays, first, stride, n, batch);
    charts_of(support, batch, lines);
    for (std::size_t i = 0; i < n; ++i) {
      if (!(rays.weight[first + i * stride] > 0.0f) || lines.chart[i] == kNoChart) continue;
      for (std::size_t d = 0; d < 2; ++d) values[lines.chart[i]][d].push_back(lines.c[d][i]);
    }
  }
  for (std::uint32_t chart = 0; chart < support.charts(); ++chart) {
    TreeBox& box = result.limits[chart];
    for (std::size_t d = 0; d < 4; ++d) {
      const auto range = support.range(chart, d);
      // Coordinates are kept in float32, whose rounding may step over the ends.
      const double slack = 1e-6 * (range[1] - range[0]);
      box.low[d] = range[0] - slack, box.high[d] = range[1] + slack;
      if (d >= 2 || values[chart][d].empty() || (range[0] > -kOpen && range[1] < kOpen)) continue;
      const auto [low, high] = core_of(values[chart][d]);
      const double margin = high - low + 1e-6 * (std::abs(low) + std::abs(high)) + 1e-9;
      box.low[d] = std::max(range[0], low - margin);
      box.high[d] = std::min(range[1], high + margin);
    }
  }
  return result;
}

Projection project(const RayBlock& rays, std::span<const float> weight, const BoundedSupport& on,
                   double tolerance_mm) {
  LUCERNA_CHECK(weight.size() == rays.size(), "{} weights for {} rays", weight.size(), rays.size());
  std::vector<TreeItem> items(rays.size());
  std::vector<std::uint8_t> chart(rays.size());
  project_all(rays, weight, on, items, chart);
  std::array<std::size_t, 256> count{};
  for (const std::uint8_t c : chart) ++count[c];
  const auto max = static_cast<std::uint32_t>(
      std::max_element(count.begin(), count.begin() + on.support.charts()) - count.begin());
  Projection result;
  std::vector<ChartItems> charts(on.support.charts());
  for (std::uint32_t c = 0; c < charts.size(); ++c) {
    charts[c].chart = c;
    if (c != max) charts[c].items.reserve(count[c]);
  }
  // The fullest chart keeps the array; the others' rays are taken out of it.
  std::size_t retained = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (chart[i] == max)
      items[retained++] = items[i];
    else if (chart[i] < charts.size())
      charts[chart[i]].items.push_back(items[i]);
    else if (chart[i] == kMissedChart) {
      result.missed.push_back(static_cast<std::uint32_t>(i));
      result.missed_weight += static_cast<double>(weight[i]);
    }
  }
  items.resize(retained);
  charts[max].items = std::move(items);
  for (ChartItems& c : charts) {
    if (c.items.empty()) continue;
    close_box(c, on.support, tolerance_mm);
    result.weight += c.weight;
    result.charts.push_back(std::move(c));
  }
  return result;
}

}  // namespace lucerna
