// SPDX-License-Identifier: Apache-2.0
// Quality of source models: size, error, floor, excess and raw in the five views, and seconds, for emitters
// of known truth and for ray files. `quality --help` has the options; docs/validation.md the commands whose
// output is quoted.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/core/file.h"
#include "lucerna/core/parallel.h"
#include "lucerna/core/png.h"
#include "lucerna/rayset/compare.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/source/cluster_compress.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/emitter.h"

namespace {

using namespace lucerna;

struct Options {
  std::vector<std::string> sources;
  std::size_t train = 10'000'000, truth = 10'000'000, draw = 10'000'000;
  std::vector<double> penalties;
  std::vector<double> prices{ClusterOptions{}.cluster_price};
  std::vector<std::uint64_t> sizes;
  std::vector<std::size_t> removal_rays{ClusterOptions{}.removal_rays};
  std::size_t rays_per_leaf = ClusterOptions{}.min_rays_per_leaf;
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

/// Grey picture of one near-plane window; `scale` is the white level.
void write_picture(const std::filesystem::path& path, const std::vector<double>& cells, double scale,
                   bool signed_values) {
  constexpr std::size_t kCells = 32, kZoom = 8;
  std::vector<std::uint8_t> pixels(kCells * kZoom * kCells * kZoom * 3);
  for (std::size_t row = 0; row < kCells * kZoom; ++row) {
    for (std::size_t column = 0; column < kCells * kZoom; ++column) {
      // First coordinate to the right, second up.
      const double x = cells[(column / kZoom) * kCells + (kCells - 1 - row / kZoom)] / scale;
      const auto level = [](double v) {
        return static_cast<std::uint8_t>(std::clamp(255.0 * v, 0.0, 255.0));
      };
      std::uint8_t* p = &pixels[3 * (row * kCells * kZoom + column)];
      p[0] = signed_values ? level(1.0 + std::min(0.0, x)) : level(x);
      p[1] = signed_values ? level(1.0 - std::abs(x)) : level(x);
      p[2] = signed_values ? level(1.0 - std::max(0.0, x)) : level(x);
    }
  }
  write_png(path, kCells * kZoom, kCells * kZoom, pixels);
}

void write_pictures(const std::string& folder, const std::string& name, const ViewCounts& truth,
                    const ViewCounts& drawn) {
  std::filesystem::create_directories(folder);
  const std::size_t n = truth.weights(ViewKind::near).size() - 1;
  std::vector<double> p(n), q(n), difference(n);
  double most = 0.0, widest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    p[i] = truth.weights(ViewKind::near)[i] / truth.total_weight();
    q[i] = drawn.weights(ViewKind::near)[i] / drawn.total_weight();
    difference[i] = q[i] - p[i];
    most = std::max(most, p[i]);
    widest = std::max(widest, std::abs(difference[i]));
  }
  const std::filesystem::path base = std::filesystem::path(folder);
  write_picture(base / (name + "-near-original.png"), p, most, false);
  write_picture(base / (name + "-near-sampled.png"), q, most, false);
  write_picture(base / (name + "-near-difference.png"), difference, widest, true);
  fmt::print(
      "    pictures: white = {:.3e} of the flux a cell; difference full colour = {:.3e} (red more, blue "
      "less)\n",
      most, widest);
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
      8.0 * static_cast<double>(s.bytes) / static_cast<double>(s.cells), model_options.cluster_price, excess,
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
  if (!options.pictures.empty()) write_pictures(options.pictures, c.name, truth, drawn);
  if (!options.save.empty()) {
    std::filesystem::create_directories(options.save);
    save_source_model(std::filesystem::path(options.save) / (c.name + ".nfl"), *model);
  }
  std::fflush(stdout);
}

void run_all(const Case& c, const Options& options) {
  const Views views(c.truth);
  ViewCounts truth(views), training(views);
  truth.add(c.truth);
  training.add(c.training.rays);
  if (!options.save.empty() || options.penalties.size() + options.sizes.size() <= 1) {
    fmt::print(
        "{}: the training rays themselves against the truth (calibration: excess 0 within its error)\n",
        c.name);
    print_views(compare_view_counts(truth, training));
  }
  const bool detail = options.penalties.size() + options.sizes.size() <= 1;
  for (const double price : options.prices) {
    for (const std::size_t removal : options.removal_rays) {
      ClusterOptions model;
      model.cluster_price = price;
      model.removal_rays = removal;
      model.min_rays_per_leaf = options.rays_per_leaf;
      if (options.penalties.empty() && options.sizes.empty())
        run(c, model, options, views, truth, training, detail);
      for (const double penalty : options.penalties) {
        model.penalty_nats = penalty;
        run(c, model, options, views, truth, training, detail);
      }
      for (const std::uint64_t size : options.sizes) {
        model.penalty_nats = ClusterOptions{}.penalty_nats;
        model.max_bytes = size;
        run(c, model, options, views, truth, training, detail);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Quality of source models in the five views of docs/algorithms/views.md");
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
  app.add_option("--rays-per-leaf", options.rays_per_leaf, "least rays in an octree leaf");
  app.add_option("--pictures", options.pictures, "folder for near-plane pictures (PNG)");
  app.add_option("--save", options.save, "folder for the models");
  app.add_option("--threads", options.threads, "worker threads");
  CLI11_PARSE(app, argc, argv);
  std::unique_ptr<ThreadLimit> limit;
  if (options.threads > 0) limit = std::make_unique<ThreadLimit>(options.threads);
  print_header();
  for (const std::string& source : options.sources) run_all(load(source, options), options);
  return 0;
}
