// SPDX-License-Identifier: Apache-2.0
// Quality of the adaptive source model against analytic emitters: bytes, excess in the five views against
// what the training rays themselves show, time.
// KIND may be a ray file: then one half of its rays trains and the other is the truth.
//   bench_adaptive KIND RAYS [max-bytes|0] [trees|0] [penalty|0] [test rays]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "lucerna/rayset/compare.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/source/adaptive_compress.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/emitter.h"

using namespace lucerna;

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void add_drawn(ViewCounts& counts, const RaySource& source, const Sequence& sequence, std::uint64_t n) {
  constexpr std::uint64_t kPiece = 1 << 20;
  for (std::uint64_t first = 0; first < n; first += kPiece) {
    RayBlock block;
    block.resize(std::min(kPiece, n - first), 0);
    source.emit(sequence, first, block);
    counts.add(block);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
  const std::string name = argc > 1 ? argv[1] : "led";
  const bool from_file = std::filesystem::exists(name);
  RaySet file;
  if (from_file) file = read_ray_set(name);
  EmitterOptions kind;
  if (!from_file) kind.kind = emitter_kind(name);
  const auto emitter = make_emitter(kind);
  const auto n = static_cast<std::size_t>(argument(2, 1e6));
  AdaptiveOptions options;
  if (argument(3, 0) > 0) options.max_bytes = static_cast<std::uint64_t>(argument(3, 0));
  if (argument(4, 0) > 0) options.trees = static_cast<int>(argument(4, 0));
  if (argument(5, 0) > 0) options.penalty_nats = argument(5, 0);
  const auto tests = static_cast<std::uint64_t>(argument(6, 4e6));
  RaySet rays;
  RayBlock reference;
  if (from_file) {
    for (RayBlock* half : {&rays.rays, &reference}) half->resize(0, file.rays.extra.size());
    for (std::size_t i = 0; i < file.rays.size(); ++i)
      (i % 2 == 0 ? reference : rays.rays).append(file.rays, i);
  } else {
    rays.rays = draw_rays(*emitter, Sequence(SequenceKind::random, 11), n);
    reference = draw_rays(*emitter, Sequence(SequenceKind::random, 12), 1 << 19);
  }
  rays.header.set_flux(1000.0);
  const auto start = std::chrono::steady_clock::now();
  const auto model = compress_adaptive(rays, options);
  const double compress_s = seconds_since(start);
  const std::size_t bytes = encode_nfl(model->to_nfl()).size();
  for (const AdaptiveLayer& layer : model->data().layers) {
    const Support& s = layer.support;
    fmt::print(
        "  layer {} map {} share {:.5f} r {:.3f} h {:.3f} o ({:.3f} {:.3f} {:.3f}) z ({:.3f} {:.3f} {:.3f}) "
        "x ({:.3f} {:.3f} {:.3f}): {}\n",
        to_string(s.kind), static_cast<int>(s.map), layer.share, s.radius_mm, s.half_size_mm.z,
        s.world_from_support.origin_mm().x, s.world_from_support.origin_mm().y,
        s.world_from_support.origin_mm().z, s.world_from_support.ez().x, s.world_from_support.ez().y,
        s.world_from_support.ez().z, s.world_from_support.ex().x, s.world_from_support.ex().y,
        s.world_from_support.ex().z, layer.why);
  }
  const Views views(reference);
  ViewCounts truth(views), test(views), training(views);
  if (from_file)
    truth.add(reference);
  else
    add_drawn(truth, *emitter, Sequence(SequenceKind::random, 13), tests);
  RayBlock some;
  some.resize(1 << 20, 0);
  model->emit(Sequence(SequenceKind::random, 6), 0, some);
  const std::clock_t drawing = std::clock();
  model->emit(Sequence(SequenceKind::random, 5), 0, some);
  const double draw_s = static_cast<double>(std::clock() - drawing) / CLOCKS_PER_SEC;
  add_drawn(test, *model, Sequence(SequenceKind::random, 14), tests);
  training.add(rays.rays);
  const RaySetComparison c = compare_view_counts(truth, test, &training);
  fmt::print("{} rays {} compress_s {:.2f} bytes {} leaves {} sample {:.1f} M/s\n", to_string(kind.kind), n,
             compress_s, bytes, model->leaves(), static_cast<double>(some.size()) * 1e-6 / draw_s);
  for (const ViewKind v : kViewKinds) {
    fmt::print("  {:7} excess {:.4f} +- {:.4f} raw {:.4f}  ratio {:.2f}\n", to_string(v), c[v].excess,
               c[v].standard_error, c[v].raw, c[v].excess / c[v].raw);
  }
}
