// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "lucerna/rays.h"
#include "lucerna/source/adaptive/charts/support_batch.h"

namespace lucerna {

/// The chart of a line that misses its support.
inline constexpr std::uint8_t kNoChart = 255;

/// Lines of a batch in the numbers of a support. Where `chart` is kNoChart the numbers mean nothing.
struct ChartBatch {
  std::array<BatchColumn, 4> c;
  std::array<std::uint8_t, kSupportBatch> chart;

  std::array<double, 4> point(std::size_t i) const { return {c[0][i], c[1][i], c[2][i], c[3][i]}; }
};

/// Rays `first`, `first + stride` ... of a block as a batch, `n` <= kSupportBatch of them; the rest repeats
/// the last.
void load_batch(const RayBlock& rays, std::size_t first, std::size_t stride, std::size_t n, RayBatch& to);

/// Support::to_chart for all rays of a batch, to within rounding: without branches or library functions, so
/// that compilers vectorise it (5 to 15 ns a line). Lines along a face of a cylinder or box are taken one at
/// a time.
void charts_of(const Support& support, const RayBatch& rays, ChartBatch& out);

}  // namespace lucerna
