// SPDX-License-Identifier: Apache-2.0
// Any bytes as a measured BRDF (.bsdf): a table of finite values that can be drawn from, or InputError.
#include <cmath>
#include <string_view>

#include "fuzz/memory_file.h"
#include "lucerna/bsdf.h"
#include "lucerna/core/io/error.h"
#include "lucerna/scatter.h"
#include "lucerna/trace/kernels/bsdf_kernel.h"
#include "lucerna/trace/kernels/measured_scatter.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lucerna;
  try {
    const BsdfTable table = parse_bsdf({reinterpret_cast<const char*>(data), size}, "bytes");
    require(table.brdf.size() == table.row(table.incidence_deg.size(), 0));
    for (const double value : table.brdf) require(value >= 0.0 && std::isfinite(value));
    if (table.brdf.size() > 10'000) return 0;
    const Scatter scatter(table);
    const BsdfView view = scatter.measured()->view();
    for (std::uint32_t i = 0; i < 8; ++i) {
      Rng rng(1, i, 0);
      const Direction mirrored = Direction::from({0.1 * i, 0.0, 1.0 - 0.1 * i});
      const Direction out = scattered_by(view, Direction{}, mirrored, rng);
      require(out.z() >= 0.0 && std::isfinite(out.x()));
    }
  } catch (const InputError&) {
    // What bad input is meant to do.
  }
  return 0;
}
