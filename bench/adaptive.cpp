// SPDX-License-Identifier: Apache-2.0
// Quality of the adaptive source model: bytes, excess in the five views beside what the training rays show,
// seconds, rays a second.
//   bench_adaptive SOURCE RAYS [test rays] [trees] [penalty] [max-bytes ...]
//   bench_adaptive table [RAYS] [test rays]
// Also how far the illuminance on the focus plane is from the truth in cells of five sizes, of the model and
// of the rays that it was made from: of the twin in 12 to 240 um, of a file in 1/128 to 1/8 of the view.
//   ONE_SUPPORT=1 bench_adaptive ...     without a second support for light that overlaps
// SOURCE is an emitter, one of own_sources.h (dome, tilted, strip, arc ...), or a ray file: then one half of
// its rays trains and the other is the truth. 0 = default; one line per ceiling. `table` prints the table of
// docs/benchmarks/source-models.md: every source with ceilings of 256, 64 and 16 kB (once where less is
// enough).
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "lucerna/ray_comparison.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/comparison/scale_counts.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "own_sources.h"
#include "scales.h"

using namespace lucerna;

namespace {

constexpr std::uint64_t kScaleRays = 48'000'000;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Million rays a second and core, random numbers, without output.
double sampling_rate(const AdaptiveModel& model) {
  constexpr std::uint64_t kRays = 1 << 21;
  RayBlock some;
  some.resize(1 << 16, 0);
  model.emit(Sequence(SequenceKind::random, 6), 0, some);
  const double start = cpu_seconds();
  for (std::uint64_t first = 0; first < kRays; first += some.size()) {
    model.emit(Sequence(SequenceKind::random, 5), first, some);
  }
  return static_cast<double>(kRays) * 1e-6 / (cpu_seconds() - start);
}

double peak_gb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e6;
}

/// Rays to train with, and what is known of the truth.
struct Case {
  std::string name;
  RaySet rays;
  std::unique_ptr<Views> views;  // the counts refer to it
  ViewCounts truth, training;
  RayBlock half;  // of a file: the rays that are the truth
};

Case make_case(const std::string& name, std::size_t train, std::uint64_t tests) {
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
    source = bench::source_named(name);
    rays.rays = draw_rays(*source, Sequence(SequenceKind::random, 11), train);
    reference = draw_rays(*source, Sequence(SequenceKind::random, 12), 1 << 19);
  }
  auto views = std::make_unique<Views>(reference);
  ViewCounts none(*views);
  Case c{std::filesystem::path(name).filename().string(), std::move(rays), std::move(views), none, none, {}};
  if (source) {
    bench::add_drawn(c.truth, *source, Sequence(SequenceKind::random, 13), tests);
  } else {
    c.truth.add(reference);
    c.half = std::move(reference);
  }
  c.training.add(c.rays.rays);
  return c;
}

void print_scales(const char* what, const std::array<double, 5>& l1) {
  fmt::print("  {}:", what);
  for (std::size_t k = 0; k < l1.size(); ++k)
    fmt::print("{} {:.4f} at {:.0f} um", k == 0 ? "" : ",", l1[k], bench::kScalesUm[k]);
  fmt::print("\n");
}

/// L1 distance of illuminance on the focus plane from the truth, of the model and of its rays: exact for the
/// twin; of a file from the half that did not train, whose own noise is in both.
void report_scales(const Case& c, const AdaptiveModel& model) {
  if (c.name == "twin") {
    bench::PlaneCells of_model, of_rays;
    RayBlock some;
    some.resize(1 << 20, 0);
    for (std::uint64_t first = 0; first < kScaleRays; first += some.size()) {
      model.emit(Sequence(SequenceKind::random, 15), first, some);
      of_model.add(some);
    }
    of_rays.add(c.rays.rays);
    print_scales("L1 of the model", bench::l1_of_scales(of_model, bench::twin::share_below));
    print_scales("L1 of its rays", bench::l1_of_scales(of_rays, bench::twin::share_below));
  } else if (!c.half.empty()) {
    ScaleCounts truth(*c.views), test(*c.views), training(*c.views);
    truth.add(c.half);
    training.add(c.rays.rays);
    test.add(draw_rays(model, Sequence(SequenceKind::random, 15), kScaleRays / 8));
    fmt::print("  excess +- its error (raw) in cells of");
    for (const ScaleDifference& s : compare_scales(truth, test, training)) {
      fmt::print(" {:.0f} um: {:.4f} +- {:.4f} ({:.4f})", 1e3 * s.cell_mm, s.difference.excess,
                 s.difference.standard_error, s.difference.raw);
    }
    fmt::print("\n");
  }
}

/// One line; returns the bytes of the file.
std::uint64_t report(const Case& c, const AdaptiveOptions& options, std::uint64_t tests, bool why) {
  const double start = cpu_seconds();
  const auto wall = std::chrono::steady_clock::now();
  const auto model = compress_adaptive(c.rays, options);
  const double used = cpu_seconds() - start;
  const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  const double peak = peak_gb();
  ViewCounts test(*c.views);
  bench::add_drawn(test, *model, Sequence(SequenceKind::random, 14), tests);
  const RaySetComparison r = compare_view_counts(c.truth, test, &c.training);
  for (const AdaptiveLayer& layer : model->data().layers) {
    if (why) fmt::print("# {}: {:.5f} {}\n", to_string(layer.support.kind), layer.share, layer.why);
  }
  const std::uint64_t bytes = encode_nfl(model->to_nfl()).size();
  fmt::print("| {} | {} | {:.1f} kB | {} |", c.name, c.rays.rays.size(), 1e-3 * static_cast<double>(bytes),
             model->leaves());
  for (const ViewKind v : kViewKinds) {
    fmt::print(" {:.4f} +- {:.4f} ({:.4f}) |", r[v].excess, r[v].standard_error, r[v].raw);
  }
  fmt::print(" {:.1f} s, {:.1f} s CPU | {:.2f} GB | {:.1f} M/s |\n", waited, used, peak,
             sampling_rate(*model));
  if (why) report_scales(c, *model);
  std::fflush(stdout);
  return bytes;
}

void print_table(std::size_t train, std::uint64_t tests) {
  fmt::print(
      "| source | rays | file | leaves | far | near | focus | beam | 4-D | compress | peak of all so far | "
      "sample, one core |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const char* name :
       {"point",   "disk",   "rectangle", "cylinder", "sphere", "filament", "led",   "phong500",
        "phong25", "radial", "cosine",    "dome",     "egg",    "tilted",   "strip", "arc",
        "ghost",   "remote", "twin",      "board",    "xenon",  "caustic"}) {
    const Case c = make_case(name, train, tests);
    std::uint64_t bytes = ~std::uint64_t{0};
    for (const std::uint64_t max : {256'000u, 64'000u, 16'000u}) {
      if (bytes <= max) continue;
      AdaptiveOptions options;
      options.max_bytes = max;
      bytes = report(c, options, tests, false);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, double otherwise) {
    return argc > i && std::atof(argv[i]) > 0.0 ? std::atof(argv[i]) : otherwise;
  };
  const std::string name = argc > 1 ? argv[1] : "led";
  const auto tests = static_cast<std::uint64_t>(argument(3, 4e6));
  if (name == "table") {
    print_table(static_cast<std::size_t>(argument(2, 1e7)), tests);
    return 0;
  }
  const Case c = make_case(name, static_cast<std::size_t>(argument(2, 1e6)), tests);
  AdaptiveOptions options;
  options.overlap = std::getenv("ONE_SUPPORT") == nullptr;
  if (argument(4, 0) > 0) options.trees = static_cast<int>(argument(4, 0));
  if (argument(5, 0) > 0) options.penalty_nats = argument(5, 0);
  for (int i = 6; i < std::max(argc, 7); ++i) {
    options.max_bytes.reset();
    if (argument(i, 0) > 0) options.max_bytes = static_cast<std::uint64_t>(argument(i, 0));
    report(c, options, tests, i == 6);
  }
}
