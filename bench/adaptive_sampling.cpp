// SPDX-License-Identifier: Apache-2.0
// Rays a second that adaptive models are drawn at, on one core and without output: every kind of support,
// both maps of directions, random and Sobol numbers. The models are made up: 4096 even leaves on each chart.
//   bench_adaptive_sampling [million rays]
//   bench_adaptive_sampling million-rays MODEL.nfl ...     the rates of these models instead
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"

using namespace lucerna;

namespace {

DensityTree even_tree(std::uint32_t depth) {
  DensityTree tree;
  tree.rays = 1e6;
  const auto add = [&tree](const auto& self, std::uint32_t levels) -> void {
    const std::size_t at = tree.nodes.size();
    tree.nodes.emplace_back();
    if (levels == 0) return;
    self(self, levels - 1);
    tree.nodes[at] = {static_cast<std::uint32_t>(tree.nodes.size() - at),
                      static_cast<std::uint8_t>(levels % 4), 32, 0};
    self(self, levels - 1);
  };
  add(add, depth);
  return tree;
}

AdaptiveData model_on(const Support& support, const BoundingSurface& surface) {
  AdaptiveData data;
  data.flux = 1.0;
  data.surface = surface;
  AdaptiveLayer layer;
  layer.support = support;
  layer.share = 1.0;
  for (std::uint32_t chart = 0; chart < support.charts(); ++chart) {
    AdaptiveChart c{chart, 1.0 / support.charts(), {}, {even_tree(12)}};
    for (std::size_t d = 0; d < 4; ++d) {
      const auto range = support.range(chart, d);
      c.box.low[d] = std::max(range[0], -1.0), c.box.high[d] = std::min(range[1], 1.0);
    }
    layer.charts.push_back(c);
  }
  data.layers.push_back(layer);
  return data;
}

/// Million rays a CPU second: the best of five runs.
double rate(const AdaptiveModel& model, SequenceKind kind, std::size_t rays) {
  RayBlock block;
  block.resize(1 << 16, 0);
  double best = 0.0;
  for (int run = 0; run < 5; ++run) {
    const std::clock_t start = std::clock();
    std::uint64_t first = 0;
    for (; first < rays; first += block.size()) model.emit(Sequence(kind, 6), first, block);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    best = std::max(best, 1e-6 * static_cast<double>(first) / seconds);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) try {
  const double millions = argc > 1 ? std::atof(argv[1]) : 2.0;
  const auto rays = static_cast<std::size_t>(1e6 * millions);
  if (argc > 2) fmt::print("| model | leaves | random | Sobol |\n|---|---|---|---|\n");
  for (int i = 2; i < argc; ++i) {
    const auto source = load_source_model(argv[i]);
    const auto* model = dynamic_cast<const AdaptiveModel*>(source.get());
    if (model == nullptr) throw InputError(fmt::format("{}: not an adaptive model", argv[i]));
    fmt::print("| {} | {} | {:.1f} | {:.1f} |\n", argv[i], model->leaves(),
               rate(*model, SequenceKind::random, rays), rate(*model, SequenceKind::sobol, rays));
  }
  if (argc > 2) return 0;
  fmt::print("| support | starts on | map | random | Sobol |\n|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < kSupportKinds + 1; ++k) {
    Support s;
    const bool dome = k == kSupportKinds;
    s.kind = dome ? SupportKind::plane : static_cast<SupportKind>(k);
    if (dome) s.dome = {{}, 3.0, 1.5};
    if (s.kind == SupportKind::sphere || s.kind == SupportKind::cylinder) s.radius_mm = 1.0;
    s.half_size_mm = {1.0, 1.0, 1.0};
    for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
      if (s.kind == SupportKind::axis && map == PolarMap::concentric) continue;
      s.map = map;
      const AdaptiveModel model(model_on(s, BoundingSurface::sphere(10.0)));
      fmt::print("| {}{} | sphere | {} | {:.1f} | {:.1f} |\n", to_string(s.kind), dome ? " in a dome" : "",
                 map == PolarMap::polar ? "polar" : "concentric", rate(model, SequenceKind::random, rays),
                 rate(model, SequenceKind::sobol, rays));
    }
  }
  Support s;
  s.kind = SupportKind::plane;
  for (const BoundingSurface& surface :
       {BoundingSurface{}, BoundingSurface::plane(1.0), BoundingSurface::cylinder(5.0, 9.0),
        BoundingSurface::box({8, 8, 9})}) {
    const AdaptiveModel model(model_on(s, surface));
    fmt::print("| plane | {} | concentric | {:.1f} | {:.1f} |\n", to_string(surface.kind),
               rate(model, SequenceKind::random, rays), rate(model, SequenceKind::sobol, rays));
  }
} catch (const std::exception& e) {
  std::fputs(e.what(), stderr);
  std::fputc('\n', stderr);
  return 1;
}
