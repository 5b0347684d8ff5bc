// SPDX-License-Identifier: Apache-2.0
// What a trace at its default noise prints, against a long trace with other random numbers: peak, beam and
// field angles, angles of the written grid within three of their stated errors. At the end a table of all
// projects; brackets have the long trace. Also the nominal case of a tolerance sweep of its default rays.
// Usage: bench_figures [TRUTH_RAYS [NOISE]] PROJECT.toml...   (default 300e6 0.01; bench/figures/*.toml)
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/validation/tolerances.h"
#include "lucerna/project.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

namespace {

using namespace lucerna;

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Look {
  BinnedIntensity nodes;
  FarFieldMetrics metrics;
};

Look look_at(const TraceResult& result, const Scene& scene) {
  FarFieldResult f = trace_metrics(result, scene).far_fields.at(0);
  return {std::move(f.intensity), std::move(f.metrics)};
}

/// Shares of the grid's angles (all; above 1 % of the peak) within k stated errors, the truth's own error
/// added.
struct Within {
  double all_3 = 0.0, bright_3 = 0.0, bright_2 = 0.0, worst_share = 0.0;
};

Within within(const BinnedIntensity& test, const BinnedIntensity& truth) {
  const auto& cd = truth.distribution.cd;
  const double peak = *std::max_element(cd.begin(), cd.end());
  double n = 0.0, bright = 0.0;
  Within w;
  for (std::size_t i = 0; i < cd.size(); ++i) {
    const double gap = std::abs(test.distribution.cd[i] - cd[i]);
    const double error = std::hypot(test.standard_error_cd[i], truth.standard_error_cd[i]);
    n += 1.0;
    w.all_3 += gap <= 3.0 * error ? 1.0 : 0.0;
    w.worst_share = std::max(w.worst_share, gap / peak);
    if (cd[i] < 0.01 * peak) continue;
    bright += 1.0;
    w.bright_3 += gap <= 3.0 * error ? 1.0 : 0.0;
    w.bright_2 += gap <= 2.0 * error ? 1.0 : 0.0;
  }
  w.all_3 /= n;
  w.bright_3 /= bright;
  w.bright_2 /= bright;
  return w;
}

/// A project's column of the table: what a row is about, and its cell.
struct Column {
  std::string name;
  std::vector<std::pair<std::string, std::string>> cells;
};

std::string text_of(const std::optional<Estimate>& e) { return e ? estimate_text(*e) : "not determined"; }

/// Prints the two side by side, and adds them to the column.
void compare(const std::string& what, const std::optional<Estimate>& test,
             const std::optional<Estimate>& truth, Column& column) {
  column.cells.emplace_back(what, fmt::format("{} ({})", text_of(test), text_of(truth)));
  if (!test || !truth) {
    fmt::print("  {:<18} {} / {}\n", what, text_of(test), text_of(truth));
    return;
  }
  fmt::print("  {:<18} {:>22} | {:>22} | {:+8.3f} {:+7.3f} % {:+5.1f} errors\n", what, estimate_text(*test),
             estimate_text(*truth), test->mean - truth->mean, 100.0 * (test->mean / truth->mean - 1.0),
             (test->mean - truth->mean) / std::hypot(test->standard_error, truth->standard_error));
}

Column run(const std::string& file, std::uint64_t truth_rays, double noise) {
  const Project project = read_project(file);
  NoiseTrace traced;
  const double trace_s =
      seconds_of([&] { traced = trace_until(project.scene, {.seed = 1}, {.noise = noise}); });
  Look test, truth;
  const double look_s = seconds_of([&] { test = look_at(traced.result, project.scene); });
  fmt::print("{}: {:.1f} M rays, node noise {:.2f} %, trace {:.2f} s, figures {:.2f} s, {} threads {}\n",
             file, 1e-6 * static_cast<double>(traced.result.last_ray), 100.0 * traced.noise, trace_s, look_s,
             ThreadLimit::current(), to_string(traced.end));
  Column column{std::filesystem::path(file).stem().string(), {}};
  column.cells.emplace_back(
      "rays, noise of the worst angle",
      fmt::format("{:.1f} M, {:.2f} %", 1e-6 * static_cast<double>(traced.result.last_ray),
                  100.0 * traced.noise));
  column.cells.emplace_back("seconds of the trace, of the figures",
                            fmt::format("{:.1f}, {:.1f}", trace_s, look_s));
  truth = look_at(trace(project.scene, {.last_ray = truth_rays, .seed = 4242}), project.scene);
  if (test.metrics.peak && truth.metrics.peak) {
    compare("peak, cd", test.metrics.peak->cd, truth.metrics.peak->cd, column);
    fmt::print(
        "  radius {:.2f} / {:.2f} deg, half width {:.2f} / {:.2f}; apart {:.2f} +- {:.2f} deg; max node "
        "{:.5g} / {:.5g}\n",
        test.metrics.peak->radius_deg, truth.metrics.peak->radius_deg, test.metrics.peak->half_width_deg,
        truth.metrics.peak->half_width_deg,
        degrees(angle_between(test.metrics.peak->direction, truth.metrics.peak->direction)),
        test.metrics.peak->direction_error_deg,
        *std::max_element(test.nodes.distribution.cd.begin(), test.nodes.distribution.cd.end()),
        *std::max_element(truth.nodes.distribution.cd.begin(), truth.nodes.distribution.cd.end()));
  }
  compare("axis, cd", test.metrics.axis_cd, truth.metrics.axis_cd, column);
  for (std::size_t i = 0; i < test.metrics.planes.size(); ++i) {
    const auto &a = test.metrics.planes[i], &b = truth.metrics.planes[i];
    if (a.c_deg != 0.0 && a.c_deg != 90.0) continue;
    compare(fmt::format("beam C{:g}, deg", a.c_deg), a.beam_of_maximum, b.beam_of_maximum, column);
    compare(fmt::format("field C{:g}, deg", a.c_deg), a.field_of_maximum, b.field_of_maximum, column);
  }
  compare("flux 0-30, lm", test.metrics.flux_0_30, truth.metrics.flux_0_30, column);
  const Within w = within(test.nodes, truth.nodes);
  fmt::print(
      "  nodes within 3 errors: {:.2f} % of all, {:.2f} % of those above 1 % of the peak (2: {:.1f} %); "
      "largest difference {:.2f} % of the peak\n",
      100.0 * w.all_3, 100.0 * w.bright_3, 100.0 * w.bright_2, 100.0 * w.worst_share);
  column.cells.emplace_back("angles of the grid within 3 stated errors, all",
                            fmt::format("{:.2f} %", 100.0 * w.all_3));
  column.cells.emplace_back("above 1 % of the peak", fmt::format("{:.2f} %", 100.0 * w.bright_3));
  return column;
}

/// The design itself as a sweep has it; ranges of 0 leave no other case.
void add_tolerances(const Scene& scene, Column& column) {
  const ToleranceRanges nothing{.source_shift_mm = 0.0,
                                .source_tilt_deg = 0.0,
                                .slope_error_mrad = 0.0,
                                .reflectance = 0.0,
                                .samples = 2};
  const ToleranceMetrics nominal = tolerance_sweep(scene, nothing, 3).figures.front();
  const auto add = [&](const char* what, const std::optional<Estimate>& e) {
    column.cells.emplace_back(fmt::format("tolerances: {}", what), e ? estimate_text(*e) : "not determined");
  };
  add("peak, cd", nominal.peak);
  add("axis, cd", nominal.centre);
  add("beam C0, deg", nominal.beam_c0_deg);
  add("beam C90, deg", nominal.beam_c90_deg);
}

/// The columns side by side; rows are those of the first.
void print_table(const std::vector<Column>& columns) {
  if (columns.empty()) return;
  std::string head = "| |", rule = "|---|";
  for (const Column& c : columns) {
    head += fmt::format(" {} |", c.name);
    rule += "---|";
  }
  fmt::print("\n{}\n{}\n", head, rule);
  for (const auto& [what, first] : columns.front().cells) {
    fmt::print("| {} |", what);
    for (const Column& c : columns) {
      const auto cell = std::ranges::find(c.cells, what, &std::pair<std::string, std::string>::first);
      fmt::print(" {} |", cell != c.cells.end() ? cell->second : "-");
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  double numbers[2] = {300e6, 0.01};
  int at = 1;
  for (double& number : numbers) {
    if (at >= argc) break;
    const std::string word = argv[at];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) break;
    ++at;
  }
  std::vector<Column> columns;
  for (; at < argc; ++at) {
    columns.push_back(run(argv[at], static_cast<std::uint64_t>(numbers[0]), numbers[1]));
    add_tolerances(read_project(argv[at]).scene, columns.back());
  }
  print_table(columns);
}
