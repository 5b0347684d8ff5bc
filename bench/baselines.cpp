// SPDX-License-Identifier: Apache-2.0
// A rate-distortion table for one source: adaptive and clusters at the same sizes, uniform light fields, and
// plain rays picked from the set; excess in the five views. `bench_baselines --help` has the options.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "light_field.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/subset.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "own_sources.h"

namespace {

using namespace lucerna;

constexpr std::uint64_t kRayBytes = 28;

struct Options {
  std::string source;
  std::size_t train = 2'000'000, draw = 2'000'000;
  std::vector<std::uint64_t> sizes{16'000, 64'000, 256'000, 1'000'000};
  std::vector<std::size_t> cells{8, 16, 32, 64};
};

struct Case {
  RaySet training;
  RayBlock truth;
};

/// A file's rays are split: odd ones train, even ones are the truth.
Case load(const Options& o) {
  Case c;
  c.training.header.set_flux(1000.0);
  if (std::filesystem::exists(o.source)) {
    const RaySet all = read_ray_set(o.source);
    for (auto* half : {&c.training.rays, &c.truth}) half->resize(0, all.rays.extra.size());
    for (std::size_t i = 0; i < all.rays.size(); ++i)
      (i % 2 == 0 ? c.truth : c.training.rays).append(all.rays, i);
    return c;
  }
  std::unique_ptr<RaySource> source = bench::own_source(o.source);
  if (!source) {
    EmitterOptions emitter;
    emitter.kind = emitter_kind(o.source);
    source = make_emitter(emitter);
  }
  c.training.rays = draw_rays(*source, Sequence(SequenceKind::random, 1), o.train);
  c.truth = draw_rays(*source, Sequence(SequenceKind::random, 2), o.draw);
  return c;
}

class Table {
 public:
  Table(const Options& options, const Case& c) : options_(options), views_(c.truth), truth_(views_) {
    truth_.add(c.truth);
    fmt::print(
        "| method | bytes | far | near | focus | beam | 4-D | seconds "
        "|\n|---|---|---|---|---|---|---|---|\n");
  }

  /// The excess of rays drawn from a model.
  void row(const std::string& method, std::uint64_t bytes, const RaySource& model, double seconds) {
    ViewCounts drawn(views_);
    drawn.add(draw_rays(model, Sequence(SequenceKind::random, 3), options_.draw));
    const RaySetComparison r = compare_view_counts(truth_, drawn);
    print(method, bytes, seconds, [&](ViewKind kind) { return r[kind].excess; });
  }

  /// Rays that are used as they are: their own noise is their error.
  void row(const std::string& method, const RayBlock& rays) {
    ViewCounts counts(views_);
    counts.add(rays);
    const RaySetComparison r = compare_view_counts(truth_, counts, &counts);
    print(method, kRayBytes * rays.size(), 0.0, [&](ViewKind kind) { return r[kind].raw; });
  }

 private:
  template <class Figure>
  void print(const std::string& method, std::uint64_t bytes, double seconds, const Figure& figure) {
    fmt::print("| {} | {} |", method, bytes);
    for (const ViewKind kind : kViewKinds) fmt::print(" {:.4f} |", figure(kind));
    fmt::print(" {:.1f} |\n", seconds);
    std::fflush(stdout);
  }

  const Options& options_;
  Views views_;
  ViewCounts truth_;
};

template <class Work>
auto timed(double& seconds, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void run(const Options& o) {
  const Case c = load(o);
  fmt::print("{}: {} training rays, {} of truth, {} drawn\n", o.source, c.training.rays.size(),
             c.truth.size(), o.draw);
  Table table(o, c);
  double s = 0.0;
  for (const std::uint64_t size : o.sizes) {
    AdaptiveOptions options;
    options.max_bytes = size;
    const auto model = timed(s, [&] { return compress_adaptive(c.training, options); });
    const std::uint64_t bytes = encode_nfl(model->to_nfl()).size();
    table.row(fmt::format("adaptive, {} asked for", size), bytes, *model, s);
    if (bytes < size * 9 / 10) break;  // all that the rays justify: more room changes nothing
  }
  for (const std::uint64_t size : o.sizes) {
    ClusterOptions options;
    options.target_bytes = size;
    ClusterStatistics made;
    const auto model = timed(s, [&] { return compress_clusters(c.training, options, no_progress(), &made); });
    table.row(fmt::format("clusters, {} asked for", size), made.bytes, *model, s);
  }
  for (const std::size_t n : o.cells) {
    const auto field = timed(s, [&] { return bench::LightField(c.training.rays, n); });
    table.row(fmt::format("light field {}^4, table {} bytes", n, field.table_bytes()), field.packed_bytes(),
              field, s);
  }
  for (const std::uint64_t size : o.sizes) {
    const auto n = static_cast<std::size_t>(size / kRayBytes);
    if (n >= c.training.rays.size()) continue;
    RayBlock picked;
    picked.resize(0, c.training.rays.extra.size());
    RaySubset(c.training.rays.size(), n, 1).select(c.training.rays, 0, picked);
    table.row("rays picked", picked);
  }
  table.row("all training rays", c.training.rays);
}

}  // namespace

int main(int argc, char** argv) try {
  Options o;
  CLI::App app("Source models side by side (docs/benchmarks/baselines.md)");
  app.add_option("source", o.source, "emitter, dome, tilted, strip, arc, or ray file")->required();
  app.add_option("--train", o.train, "training rays of emitters");
  app.add_option("--draw", o.draw, "rays drawn from each model, and of the truth");
  app.add_option("--size", o.sizes, "bytes of adaptive, clusters and picked rays")->delimiter(',');
  app.add_option("--cells", o.cells, "cells along each axis of light fields")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  run(o);
  return 0;
} catch (const std::exception& e) {
  std::fputs(e.what(), stderr);
  std::fputc('\n', stderr);
  return 1;
}
