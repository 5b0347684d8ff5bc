// SPDX-License-Identifier: Apache-2.0
// Quality of source models: size, error, floor, excess and raw in the five views, and seconds, for emitters
// of known truth and for ray files. `quality --help` has the options; docs/benchmarks/source-models.md the
// commands whose output is quoted.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/comparison/view_picture.h"
#include "lucerna/source.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace {

using namespace lucerna;

struct Options {
  std::vector<std::string> sources;
  std::size_t train = 10'000'000, truth = 10'000'000, draw = 10'000'000;
  std::vector<double> penalties;
  std::vector<double> prices{ClusterOptions{}.cluster_price};
  std::vector<std::uint64_t> sizes;
  std::vector<std::size_t> removal_rays{ClusterOptions{}.removal_rays};
  std::vector<std::uint64_t> targets;
  std::vector<std::size_t> clusters, leaves{ClusterOptions{}.max_leaves}, min{ClusterOptions{}.min_clusters};
  std::vector<int> level_steps{ClusterOptions{}.level_step};
  std::string pictures, save;
  int threads = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_gb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e6;
}

/// Training rays and independent rays of the truth. A file's rays are split: odd ones train, even ones are
/// the truth.
struct Case {
  std::string name;
  RaySet training;
  RayBlock truth;
};

Case load(const std::string& name, const Options& options) {
  Case c;
  c.name = name;
  if (std::filesystem::exists(name)) {
    const RaySet all = read_ray_set(name);
    c.name = std::filesystem::path(name).stem().string();
    c.training.header.flux_unit = all.header.flux_unit;
    c.training.header.set_flux(all.header.flux().value_or(1.0));
    for (auto* half : {&c.training.rays, &c.truth}) half->resize(0, all.rays.extra.size());
    for (std::size_t i = 0; i < all.rays.size(); ++i)
      (i % 2 == 0 ? c.truth : c.training.rays).append(all.rays, i);
    return c;
  }
  EmitterOptions emitter;
  emitter.kind = emitter_kind(name);
  const auto source = make_emitter(emitter);
  c.training.header.set_flux(source->flux());
  c.training.rays = draw_rays(*source, Sequence(SequenceKind::random, 1), options.train);
  c.truth = draw_rays(*source, Sequence(SequenceKind::random, 2), options.truth);
  return c;
}

void print_header() {
  fmt::print("{:<18} {:>8} {:>7} {:>6} {:>6} {:>8} {:>8} {:>6} {:>5} | {:<29} | {:>6} {:>6} {:>6} {:>5}\n",
             "source", "penalty", "leaves", "clust", "tri", "cells", "bytes", "b/cell", "t",
             "excess far/near/focus/beam/4-D, %", "oct s", "rem s", "fin s", "Mr/s");
}

void print_views(const RaySetComparison& r) {
  for (const ViewKind kind : kViewKinds) {
    const ViewDifference& d = r[kind];
    fmt::print("    {:<7} error {:.4f} floor {:.4f} raw {:.4f} excess {:.4f} +- {:.4f}\n", to_string(kind),
               d.error, d.floor, d.raw, d.excess, d.standard_error);
  }
}

/// Shares of the flux a cell on the near plane, in a window one and a half radii of the source to each side:
/// the view's own window holds 99 % of the flux, also what leaves nearly along the plane, and is far wider.
std::vector<double> near_picture(const Views& views, const RayBlock& rays, std::size_t cells,
                                 double half_mm) {
  std::vector<double> picture(cells * cells, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double w = static_cast<double>(rays.weight[i]);
    total += w;
    const auto at = views.coordinates(ViewKind::near, rays.ray(i));
    if (!at) continue;
    const double x = 0.5 * ((*at)[0] / half_mm + 1.0), y = 0.5 * ((*at)[1] / half_mm + 1.0);
    if (!(x >= 0.0 && x < 1.0 && y >= 0.0 && y < 1.0)) continue;
    const auto n = static_cast<double>(cells);
    picture[static_cast<std::size_t>(x * n) * cells + static_cast<std::size_t>(y * n)] += w;
  }
  for (double& x : picture) x /= total;
  return picture;
}

void write_picture(const std::string& folder, const std::string& name, const Views& views,
                   const RayBlock& truth, const RayBlock& drawn) {
  constexpr std::size_t kCells = 64;
  std::filesystem::create_directories(folder);
  const double half_mm = 1.5 * std::max(1e-3, views.frame().radius_mm);
  const ComparisonPicture p = comparison_picture(kCells, kCells, near_picture(views, truth, kCells, half_mm),
                                                 near_picture(views, drawn, kCells, half_mm), 4);
  write_png(std::filesystem::path(folder) / (name + "-near.png"), p.width, p.height, p.rgb);
  fmt::print("    picture: {:.4g} mm wide, white = {:.3e} of the flux a cell; full colour = {:.3e}\n",
             2.0 * half_mm, p.white, p.difference);
}

void run(const Case& c, const ClusterOptions& model_options, const Options& options, const Views& views,
         const ViewCounts& truth, const ViewCounts& training, bool detail) {
  ClusterStatistics s;
  const auto model = compress_clusters(c.training, model_options, no_progress(), &s);
  const auto start = std::chrono::steady_clock::now();
  const RayBlock rays = draw_rays(*model, Sequence(SequenceKind::random, 3), options.draw);
  const double drawn_s = seconds_since(start);
  ViewCounts drawn(views);
  drawn.add(rays);
  const RaySetComparison r = compare_view_counts(truth, drawn, &training);
  std::string excess;
  for (const ViewKind kind : kViewKinds) excess += fmt::format("{:5.2f} ", 100.0 * r[kind].excess);
  fmt::print(
      "{:<18} {:>8.3g} {:>7} {:>6} {:>6} {:>8} {:>8} {:>6.2f} {:>5.2g} | {:<33} | {:>6.2f} {:>6.2f} {:>6.2f} "
      "{:>5.1f}\n",
      c.name, s.penalty_nats, s.octree_leaves, s.clusters, s.triangles, s.cells, s.bytes,
      8.0 * static_cast<double>(s.bytes) / static_cast<double>(s.cells), s.cluster_price, excess,
      s.seconds_octree, s.seconds_removal, s.seconds_final,
      static_cast<double>(options.draw) / drawn_s / 1e6);
  if (detail) {
    fmt::print(
        "    surface {}, {} rounds, {} cells with light, {} rays, flux {:.9g} of {:.9g}, peak memory {:.2f} "
        "GB\n",
        to_string(model->data().surface.kind), s.rounds, s.cells_with_light, s.rays, model->flux(),
        *c.training.header.flux(), peak_gb());
    print_views(r);
    for (const ViewKind kind : kViewKinds) {
      double norm = 0.0, cells = 0.0;
      const std::size_t rest = views.cell_count(kind) - 1;
      const auto share = [&](const ViewCounts& counts, std::size_t i) {
        return counts.weights(kind)[i] / counts.total_weight();
      };
      for (std::size_t i = 0; i <= rest; ++i) {
        norm += share(truth, i) * share(truth, i);
        if (i < rest) cells += std::pow(share(truth, i) - share(drawn, i), 2.0);
      }
      fmt::print(
          "    {:<7} outside the window {:.4f} of the truth, {:.4f} of the model; error inside alone "
          "{:.4f}\n",
          to_string(kind), share(truth, rest), share(drawn, rest), std::sqrt(cells / norm));
    }
  }
  if (!options.pictures.empty()) write_picture(options.pictures, c.name, views, c.truth, rays);
  if (!options.save.empty()) {
    std::filesystem::create_directories(options.save);
    save_source_model(std::filesystem::path(options.save) / (c.name + ".nfl"), *model);
  }
  std::fflush(stdout);
}

/// One setting for each combination of what is swept.
std::vector<ClusterOptions> settings_of(const Options& o) {
  std::vector<ClusterOptions> list(1);
  const auto sweep = [&](const auto& values, const auto& set) {
    if (values.empty()) return;
    std::vector<ClusterOptions> next;
    for (const ClusterOptions& setting : list) {
      for (const auto& value : values) {
        next.push_back(setting);
        set(next.back(), value);
      }
    }
    list = std::move(next);
  };
  sweep(o.leaves, [](ClusterOptions& c, std::size_t x) { c.max_leaves = x; });
  sweep(o.removal_rays, [](ClusterOptions& c, std::size_t x) { c.removal_rays = x; });
  sweep(o.min, [](ClusterOptions& c, std::size_t x) { c.min_clusters = x; });
  sweep(o.level_steps, [](ClusterOptions& c, int x) { c.level_step = x; });
  sweep(o.prices, [](ClusterOptions& c, double x) { c.cluster_price = x; });
  sweep(o.penalties, [](ClusterOptions& c, double x) { c.penalty_nats = x; });
  sweep(o.clusters, [](ClusterOptions& c, std::size_t x) { c.max_clusters = x; });
  sweep(o.sizes, [](ClusterOptions& c, std::uint64_t x) { c.max_bytes = x; });
  sweep(o.targets, [](ClusterOptions& c, std::uint64_t x) { c.target_bytes = x; });
  return list;
}

void run_all(const Case& c, const Options& options) {
  const Views views(c.truth);
  ViewCounts truth(views), training(views);
  truth.add(c.truth);
  training.add(c.training.rays);
  if (settings_of(options).size() == 1) {
    fmt::print(
        "{}: the training rays themselves against the truth (calibration: excess 0 within its error)\n",
        c.name);
    print_views(compare_view_counts(truth, training));
  }
  const std::vector<ClusterOptions> settings = settings_of(options);
  for (const ClusterOptions& setting : settings)
    run(c, setting, options, views, truth, training, settings.size() == 1);
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  CLI::App app("Quality of source models in the five views of docs/theory/comparison.md");
  app.add_option("sources", options.sources, "emitters (phong500, led, filament, ...) and ray files")
      ->required();
  app.add_option("--train", options.train, "training rays of emitters");
  app.add_option("--truth", options.truth, "independent rays of emitters");
  app.add_option("--draw", options.draw, "rays drawn from each model");
  app.add_option("--penalty", options.penalties, "nats a split, several for a sweep")->delimiter(',');
  app.add_option("--price", options.prices, "splits a cluster, several for a sweep")->delimiter(',');
  app.add_option("--size", options.sizes, "largest file in bytes, several for a rate-distortion table")
      ->delimiter(',');
  app.add_option("--removal-rays", options.removal_rays, "rays that decide removals, several for a sweep")
      ->delimiter(',');
  app.add_option("--target", options.targets, "sizes to use up, for a rate-distortion table")->delimiter(',');
  app.add_option("--clusters", options.clusters, "most clusters, several for a sweep")->delimiter(',');
  app.add_option("--leaves", options.leaves, "most leaves of the octree, several for a sweep")
      ->delimiter(',');
  app.add_option("--min-clusters", options.min, "clusters that always stay, several for a sweep")
      ->delimiter(',');
  app.add_option("--level-step", options.level_steps, "steps of stored weights, several for a sweep")
      ->delimiter(',');
  app.add_option("--pictures", options.pictures, "folder for near-plane pictures (PNG)");
  app.add_option("--save", options.save, "folder for the models");
  app.add_option("--threads", options.threads, "worker threads");
  CLI11_PARSE(app, argc, argv);
  std::unique_ptr<ThreadLimit> limit;
  if (options.threads > 0) limit = std::make_unique<ThreadLimit>(options.threads);
  print_header();
  for (const std::string& source : options.sources) run_all(load(source, options), options);
  return 0;
} catch (const std::exception& e) {
  std::fputs(e.what(), stderr);
  std::fputc('\n', stderr);
  return 1;
}
