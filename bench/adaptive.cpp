// SPDX-License-Identifier: Apache-2.0
// Quality of the adaptive source model: bytes, excess in the five views beside what the training rays show,
// CPU seconds, rays a second.
//   bench_adaptive SOURCE RAYS [test rays] [trees] [penalty] [max-bytes ...]
// SOURCE is an emitter, one of own_sources.h (dome, tilted, strip, arc), or a ray file: then one half of its
// rays trains and the other is the truth. 0 = default; one line per ceiling.
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "lucerna/rayset/compare.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/source/adaptive_compress.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/emitter.h"
#include "own_sources.h"

using namespace lucerna;

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void add_drawn(ViewCounts& counts, const RaySource& source, const Sequence& sequence, std::uint64_t n) {
  constexpr std::uint64_t kPiece = 1 << 20;
  RayBlock block;
  for (std::uint64_t first = 0; first < n; first += kPiece) {
    block.resize(std::min(kPiece, n - first), 0);
    source.emit(sequence, first, block);
    counts.add(block);
  }
}

std::unique_ptr<RaySource> source_named(const std::string& name) {
  if (auto own = bench::own_source(name)) return own;
  EmitterOptions options;
  options.kind = emitter_kind(name);
  return make_emitter(options);
}

/// Million rays a second and core, random numbers, without output.
double sampling_rate(const AdaptiveModel& model) {
  RayBlock some;
  some.resize(1 << 20, 0);
  model.emit(Sequence(SequenceKind::random, 6), 0, some);
  const double start = cpu_seconds();
  model.emit(Sequence(SequenceKind::random, 5), 0, some);
  return static_cast<double>(some.size()) * 1e-6 / (cpu_seconds() - start);
}

void report(const std::string& name, const RaySet& rays, const Views& views, const ViewCounts& truth,
            const ViewCounts& training, const AdaptiveOptions& options, std::uint64_t tests, bool first) {
  const double start = cpu_seconds();
  const auto model = compress_adaptive(rays, options);
  const double used = cpu_seconds() - start;
  ViewCounts test(views);
  add_drawn(test, *model, Sequence(SequenceKind::random, 14), tests);
  const RaySetComparison c = compare_view_counts(truth, test, &training);
  for (const AdaptiveLayer& layer : model->data().layers) {
    if (first) fmt::print("# {}: {:.5f} {}\n", to_string(layer.support.kind), layer.share, layer.why);
  }
  fmt::print("| {} | {} | {:.1f} kB | {} |", name, rays.rays.size(),
             1e-3 * static_cast<double>(encode_nfl(model->to_nfl()).size()), model->leaves());
  for (const ViewKind v : kViewKinds) {
    fmt::print(" {:.4f} +- {:.4f} ({:.4f}) |", c[v].excess, c[v].standard_error, c[v].raw);
  }
  fmt::print(" {:.1f} s CPU | {:.1f} M/s |\n", used, sampling_rate(*model));
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, double otherwise) {
    return argc > i && std::atof(argv[i]) > 0.0 ? std::atof(argv[i]) : otherwise;
  };
  const std::string name = argc > 1 ? argv[1] : "led";
  const auto tests = static_cast<std::uint64_t>(argument(3, 4e6));
  RaySet rays;
  RayBlock reference;
  std::unique_ptr<RaySource> source;
  rays.header.set_flux(1000.0);
  if (std::filesystem::exists(name)) {
    const RaySet file = read_ray_set(name);
    for (RayBlock* half : {&rays.rays, &reference}) half->resize(0, file.rays.extra.size());
    for (std::size_t i = 0; i < file.rays.size(); ++i) {
      (i % 2 == 0 ? reference : rays.rays).append(file.rays, i);
    }
  } else {
    source = source_named(name);
    rays.rays =
        draw_rays(*source, Sequence(SequenceKind::random, 11), static_cast<std::size_t>(argument(2, 1e6)));
    reference = draw_rays(*source, Sequence(SequenceKind::random, 12), 1 << 19);
  }
  const Views views(reference);
  ViewCounts truth(views), training(views);
  if (source)
    add_drawn(truth, *source, Sequence(SequenceKind::random, 13), tests);
  else
    truth.add(reference);
  training.add(rays.rays);
  AdaptiveOptions options;
  if (argument(4, 0) > 0) options.trees = static_cast<int>(argument(4, 0));
  if (argument(5, 0) > 0) options.penalty_nats = argument(5, 0);
  for (int i = 6; i < std::max(argc, 7); ++i) {
    options.max_bytes.reset();
    if (argument(i, 0) > 0) options.max_bytes = static_cast<std::uint64_t>(argument(i, 0));
    report(std::filesystem::path(name).filename().string(), rays, views, truth, training, options, tests,
           i == 6);
  }
}
