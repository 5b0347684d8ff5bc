// SPDX-License-Identifier: Apache-2.0
// Excess of adaptive models of several independent sets of training rays, relative to raw, and what of it is
// bias (common to all sets) or noise (of each).
//   bench_adaptive_bias SOURCE [RAYS] [SETS] [TEST RAYS]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "lucerna/bounding_surface.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "own_sources.h"

using namespace lucerna;

int main(int argc, char** argv) {
  const auto argument = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
  const std::string name = argc > 1 ? argv[1] : "strip";
  const auto n = static_cast<std::size_t>(argument(2, 1e5));
  const auto sets = static_cast<std::uint64_t>(std::max(2.0, argument(3, 4)));
  const auto tests = static_cast<std::uint64_t>(argument(4, 1e6));
  const auto source = bench::source_named(name);
  const Views views(draw_rays(*source, Sequence(SequenceKind::random, 12), 1 << 19));
  ViewCounts truth(views), pooled(views);
  bench::add_drawn(truth, *source, Sequence(SequenceKind::random, 13), 2 * tests);
  std::array<double, 5> squares{}, raw{};
  double bytes = 0.0;
  for (std::uint64_t k = 0; k < sets; ++k) {
    RaySet rays;
    rays.header.set_flux(1000.0);
    rays.rays = draw_rays(*source, Sequence(SequenceKind::random, 100 + k), n);
    const auto model = compress_adaptive(rays, {});
    bytes += static_cast<double>(encode_nfl(model->to_nfl()).size());
    ViewCounts test(views), training(views);
    training.add(rays.rays);
    for (ViewCounts* counts : {&test, &pooled}) {
      bench::add_drawn(*counts, *model, Sequence(SequenceKind::random, 14 + 1000 * k), tests);
    }
    const RaySetComparison r = compare_view_counts(truth, test, &training);
    for (std::size_t v = 0; v < 5; ++v) {
      squares[v] += r[kViewKinds[v]].excess * r[kViewKinds[v]].excess;
      raw[v] = r[kViewKinds[v]].raw;
    }
  }
  const RaySetComparison all = compare_view_counts(truth, pooled);
  const auto count = static_cast<double>(sets);
  fmt::print("{}: {:.1f} kB", name, 1e-3 * bytes / count);
  for (std::size_t v = 0; v < 5; ++v) {
    const double one = squares[v] / count, together = all[kViewKinds[v]].excess;
    // Of the sets together the noise is a `count`th in squares.
    const double noise = std::max(0.0, one - together * together) * count / (count - 1.0);
    fmt::print(" | {} {:.2f} (bias {:.2f}, noise {:.2f})", to_string(kViewKinds[v]), std::sqrt(one) / raw[v],
               std::sqrt(std::max(0.0, one - noise)) / raw[v], std::sqrt(noise) / raw[v]);
  }
  fmt::print("\n");
}
