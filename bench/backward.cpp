// SPDX-License-Identifier: Apache-2.0
// Processor seconds until every angle of the written grid above 1 % of the peak has an error of 1 % of the
// peak: by forward rays, by backward ones, and by both together, weighted by their variances in the best
// split. Errors and seconds are measured once of each (4 M forward rays; 16 replicates of SAMPLES backward
// rays a cell) and scaled as 1 / sqrt(n).
// Usage: bench_backward [SAMPLES] PROJECT.toml...   (default 256; bench/figures/*.toml)
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/project.h"
#include "lucerna/random.h"
#include "lucerna/trace.h"
#include "lucerna/trace/backward/backward_estimator.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace/result/node_noise.h"

namespace {

using namespace lucerna;

constexpr double kGoal = 0.01, kBrightShare = 0.01;
constexpr std::uint64_t kForwardRays = 1 << 22;

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Errors by angle of the grid, as shares of the peak, and what they took.
struct Measured {
  std::vector<double> error;
  double seconds = 0.0;
  double worst() const { return *std::max_element(error.begin(), error.end()); }
  double seconds_to_goal() const { return seconds * std::pow(worst() / kGoal, 2.0); }
};

/// Samples of a cell: fewer where angles are pooled about the poles.
std::uint64_t samples_of(const DirectionCell& cell, std::uint64_t max) {
  const double wide =
      (cell.c1_rad - cell.c0_rad) * std::max(std::sin(cell.gamma0_rad), std::sin(cell.gamma1_rad));
  const double share = std::min(1.0, wide / (cell.gamma1_rad - cell.gamma0_rad));
  std::uint64_t n = max;
  while (n > 4 && static_cast<double>(n) > 1.5 * share * static_cast<double>(max)) n /= 2;
  return n;
}

DirectionCell cell_of(const FarField& f, std::size_t i) {
  const double c = radians(f.c_step_deg), g = radians(f.gamma_step_deg);
  const std::size_t plane = i / f.gamma_count;
  const double at_c = c * static_cast<double>(plane), at_g = g * static_cast<double>(i % f.gamma_count);
  return {at_c - 0.5 * c, at_c + 0.5 * c, std::max(0.0, at_g - 0.5 * g),
          std::min(radians(180.0), at_g + 0.5 * g)};
}

/// The far field with the flux of `cells` by backward rays.
CountedFarField traced_backward(const Scene& scene, const CountedFarField& forward,
                                const std::vector<std::size_t>& cells, std::uint64_t samples) {
  const BackwardEstimator estimator(scene);
  CountedFarField out = forward;
  out.replicated = JackknifedFlux(out.flux.size(), 16);
  for (std::size_t i = 0; i < out.flux.size(); ++i) {
    for (double& v : out.replicated.row(i)) v = out.flux[i];
  }
  parallel_blocks(cells.size(), 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const DirectionCell cell = cell_of(forward, cells[k]);
      std::array<std::uint64_t, 16> seeds;
      for (std::size_t r = 0; r < seeds.size(); ++r) seeds[r] = detail::mix_bits(16 * cells[k] + r + 1);
      const auto flux = estimator.cell_flux(cell, 1, 1, samples_of(cell, samples), seeds);
      const double sum = std::accumulate(flux.begin(), flux.end(), 0.0);
      const auto row = out.replicated.row(cells[k]);
      row[0] = out.flux[cells[k]] = sum / 16.0;
      for (std::size_t r = 0; r < 16; ++r) row[r + 1] = (sum - flux[r]) / 15.0;
    }
  });
  return out;
}

std::vector<double> errors_at(const BinnedIntensity& nodes, const std::vector<std::size_t>& cells,
                              double peak) {
  std::vector<double> out;
  out.reserve(cells.size());
  for (const std::size_t i : cells) out.push_back(nodes.standard_error_cd[i] / peak);
  return out;
}

/// The least seconds over all numbers of forward rays, when backward rays fill up what each angle lacks.
double combined_seconds(const Measured& forward, const Measured& backward) {
  const double per_angle = backward.seconds / static_cast<double>(backward.error.size());
  double best = std::min(forward.seconds_to_goal(), backward.seconds_to_goal());
  for (int percent = 0; percent <= 100; ++percent) {
    const double f = 0.01 * percent * std::pow(forward.worst() / kGoal, 2.0);
    double seconds = f * forward.seconds;
    for (std::size_t i = 0; i < forward.error.size(); ++i) {
      const double lacking = 1.0 / (kGoal * kGoal) - f / std::pow(forward.error[i], 2.0);
      seconds += per_angle * std::max(0.0, lacking) * std::pow(backward.error[i], 2.0);
    }
    best = std::min(best, seconds);
  }
  return best;
}

/// All of a scene's row in the table but the axis.
std::string run(const std::string& file, std::uint64_t samples) {
  const Project project = read_project(file);
  Measured forward, backward;
  forward.seconds = -processor_seconds();
  const CountedFarField field = far_field(trace(project.scene, {.last_ray = kForwardRays}), 0);
  forward.seconds += processor_seconds();
  const BinnedIntensity nodes = node_intensity(field);
  const auto& cd = nodes.distribution.cd;
  const double peak = *std::max_element(cd.begin(), cd.end());
  std::vector<std::size_t> cells;
  for (std::size_t i = 0; i < cd.size(); ++i) {
    if (cd[i] >= kBrightShare * peak) cells.push_back(i);
  }
  forward.error = errors_at(nodes, cells, peak);
  backward.seconds = -processor_seconds();
  const CountedFarField seen = traced_backward(project.scene, field, cells, samples);
  backward.seconds += processor_seconds();
  backward.error = errors_at(node_intensity(seen), cells, peak);
  std::string row =
      fmt::format("| {} | {} | {:.3g} s | {:.3g} s | {:.3g} s |", std::filesystem::path(file).stem().string(),
                  cells.size(), forward.seconds_to_goal(), backward.seconds_to_goal(),
                  combined_seconds(forward, backward));
  fmt::print("  measured: forward {:.2f} % in {:.2f} s, backward {:.2f} % in {:.2f} s\n",
             100.0 * forward.worst(), forward.seconds, 100.0 * backward.worst(), backward.seconds);
  return row;
}

/// One direction: a lone figure has no other angles to share its rays with.
std::string run_one(const std::string& file) {
  const Project project = read_project(file);
  const BackwardEstimator estimator(project.scene);
  const double start = processor_seconds();
  const Estimate axis = estimator.intensity_cd(Direction::from_unit({0.0, 0.0, -1.0}), 1024);
  return fmt::format(" {}, {:.3f} s |", estimate_text(axis, "cd"), processor_seconds() - start);
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t samples = 256;
  int at = 1;
  if (at < argc && std::atoi(argv[at]) > 0) samples = static_cast<std::uint64_t>(std::atoi(argv[at++]));
  fmt::print(
      "| scene | angles | forward | backward | combined | axis alone, backward "
      "|\n|---|---|---|---|---|---|\n");
  for (; at < argc; ++at) {
    const std::string row = run(argv[at], samples);
    fmt::print("{}{}\n", row, run_one(argv[at]));
  }
}
