// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/photometry/binning/jackknife.h"
#include "lucerna/trace.h"
#include "lucerna/trace/tally/wide_sums.h"

namespace lucerna {

/// Flux by cell, and without each replicate that has rays: the ratio estimator X / E of the rest of the run.
/// `units(replicate, cell)` is a whole number of units. No replicates if fewer than two have rays.
template <class Units>
JackknifedFlux jackknifed_flux(const TraceResult& result, std::size_t cells, const Units& quanta) {
  std::vector<const Tally*> used;
  double emitted = 0.0;
  for (const Tally& t : result.replicates) {
    emitted += static_cast<double>(emitted_of(t));
    if (emitted_of(t) > 0) used.push_back(&t);
  }
  LUCERNA_CHECK(emitted > 0.0, "nothing was emitted");
  const std::size_t replicates = used.size() < 2 ? 0 : used.size();
  std::vector<double> per_unit{result.flux / emitted};
  for (std::size_t r = 0; r < replicates; ++r)
    per_unit.push_back(result.flux / (emitted - static_cast<double>(emitted_of(*used[r]))));
  JackknifedFlux out(cells, replicates);
  parallel_blocks(cells, 4096, [&](std::size_t first, std::size_t last) {
    std::vector<Int128> x(used.size());
    for (std::size_t cell = first; cell < last; ++cell) {
      Int128 sum = 0;
      for (std::size_t r = 0; r < used.size(); ++r) sum += x[r] = quanta(*used[r], cell);
      const auto row = out.row(cell);
      row[0] = static_cast<double>(sum) * per_unit[0];
      for (std::size_t r = 0; r < replicates; ++r)
        row[r + 1] = static_cast<double>(sum - x[r]) * per_unit[r + 1];
    }
  });
  return out;
}

}  // namespace lucerna
