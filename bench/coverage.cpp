// SPDX-License-Identifier: Apache-2.0
// How often do stated intervals hold the truth? `runs` prints the figures of many short traces; `truth` what
// they should be: peak, axis and sections by backward light in single directions, without cells and kernels,
// fluxes from a long trace. A line a figure: scene, seed, figure, value, standard error.
// bench/coverage.py calls it and compares them. Runs of one scene may be split over several calls.
// Usage: bench_coverage runs PROJECT.toml RAYS FIRST_SEED LAST_SEED [counted]    counted: no backward light
//        bench_coverage truth PROJECT.toml RAYS RUNS.csv                         RUNS has where to look
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/metrics/far_field_metrics.h"
#include "lucerna/project.h"
#include "lucerna/trace.h"
#include "lucerna/trace/backward/backward_estimator.h"
#include "lucerna/trace/metrics/backward_intensity.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace {

using namespace lucerna;

constexpr std::array<double, 4> kPlanes_deg{0.0, 45.0, 90.0, 135.0};

/// Prints lines of one run; the truth has seed 0.
class Lines {
 public:
  Lines(std::string scene, std::uint64_t seed) : scene_(std::move(scene)), seed_(seed) {}
  void add(std::string_view name, const Estimate& e) const {
    fmt::print("{},{},{},{:.9g},{:.4g}\n", scene_, seed_, name, e.mean, e.standard_error);
  }
  void add(std::string_view name, const std::optional<Estimate>& e) const {
    if (e) add(name, *e);
  }
  template <std::size_t N>
  void add(std::string_view name, const std::array<Estimate, N>& values) const {
    for (std::size_t i = 0; i < N; ++i) add(fmt::format("{} {}", name, i), values[i]);
  }
  void add(const Direction& d) const {
    fmt::print("{},{},direction,{:.12g} {:.12g} {:.12g},0\n", scene_, seed_, d.x(), d.y(), d.z());
  }

 private:
  std::string scene_;
  std::uint64_t seed_;
};

void print_fluxes(const FarFieldMetrics& m, const Lines& lines) {
  lines.add("zone", m.zonal);
  lines.add("flux code N", m.cie_flux_code);
  lines.add("TM-15 zone", m.bug_zones);
  lines.add("glare", m.glare_cd);
}

void print_figures(const FarFieldMetrics& m, const Lines& lines) {
  lines.add("axis", m.axis_cd);
  if (m.peak) {
    lines.add(m.peak->direction);
    lines.add("peak", m.peak->cd);
    lines.add("peak gamma", m.peak->gamma_deg);
    lines.add("peak C", m.peak->c_deg);
  }
  lines.add("cut-off", m.cut_off_deg);
  for (const auto& p : m.planes) {
    lines.add(fmt::format("C{} beam", p.c_deg), p.beam_of_maximum);
    lines.add(fmt::format("C{} field", p.c_deg), p.field_of_maximum);
    lines.add(fmt::format("C{} beam of centre", p.c_deg), p.beam_of_centre);
    lines.add(fmt::format("C{} field of centre", p.c_deg), p.field_of_centre);
  }
  print_fluxes(m, lines);
}

void print_run(const Scene& scene, const std::string& name, std::uint64_t rays, std::uint64_t seed,
               bool counted) {
  const TraceResult result = trace(scene, {.last_ray = rays, .seed = seed});
  const PointIntensity exact =
      counted ? PointIntensity()
              : backward_intensity(scene, result.max_bounces, seed, far_field(result, 0), no_stop());
  const std::vector<double> planes(kPlanes_deg.begin(), kPlanes_deg.end());
  print_figures(far_field_metrics(counted_far_field(result, 0), planes, exact), Lines(name, seed));
}

/// Truths by backward light.
class Truth {
 public:
  Truth(const Scene& scene, Lines lines) : backward_(scene), lines_(std::move(lines)) {}

  /// The highest that five searches from the brightest of `starts` find.
  Estimate peak(const std::vector<Direction>& starts) const {
    std::vector<std::pair<double, Direction>> found;
    for (const Direction& d : starts) found.emplace_back(cd(d, 2048), d);
    const auto brighter = [](const auto& a, const auto& b) { return a.first > b.first; };
    std::sort(found.begin(), found.end(), brighter);
    found.resize(std::min<std::size_t>(found.size(), 5));
    for (auto& f : found) f = climbed(f.second);
    const Direction top = std::min_element(found.begin(), found.end(), brighter)->second;
    const Estimate peak = backward_.intensity_cd(top, kPrecise, 16, kFreshSeed);
    const TypeCAngles at = type_c_angles(top);
    lines_.add("peak", peak);
    lines_.add("peak gamma", Estimate{degrees(at.gamma_rad), kLastStep_deg});
    lines_.add("peak C", Estimate{degrees(at.c_rad), kLastStep_deg / std::max(std::sin(at.gamma_rad), 1e-3)});
    return peak;
  }

  Estimate axis() const {
    const Estimate axis =
        backward_.intensity_cd(Direction::from_unit({0.0, 0.0, -1.0}), kPrecise, 16, kFreshSeed);
    lines_.add("axis", axis);
    return axis;
  }

  /// All arcs of one section.
  void section(double c_deg, const Estimate& peak, const Estimate& axis) const {
    std::vector<CirclePoint> circle(1440);
    parallel_blocks(circle.size(), 1, [&](std::size_t i, std::size_t) {
      const double angle = 0.25 * static_cast<double>(i);
      circle[i] = {angle, cd(at(c_deg, angle), 256)};
    });
    const auto arc = [&](const char* name, const Estimate& full, double share) {
      if (full.mean > 0.0)
        lines_.add(fmt::format("C{} {}", c_deg, name),
                   arc_deg(c_deg, circle, {share * full.mean, share * full.standard_error}));
    };
    arc("beam", peak, 0.5);
    arc("field", peak, 0.1);
    arc("beam of centre", axis, 0.5);
    arc("field of centre", axis, 0.1);
  }

 private:
  static constexpr std::uint64_t kPrecise = 1 << 15, kSeed = 7, kFreshSeed = 99;
  static constexpr double kLastStep_deg = 0.005, kNearest_deg = 0.001;
  /// A line that leaves so much more than the variances of its points is none.
  static constexpr double kBends = 4.0;

  double cd(const Direction& d, std::uint64_t samples) const {
    return backward_.intensity_cd(d, samples, 16, kSeed).mean;
  }

  static Direction at(double c_deg, double angle_deg) {
    const double a = radians(angle_deg), c = radians(c_deg);
    return Direction::from_unit({std::sin(a) * std::cos(c), std::sin(a) * std::sin(c), -std::cos(a)});
  }

  std::pair<double, Direction> climbed(Direction d) const {
    double best = cd(d, 4096);
    for (double step = 0.1; step > kLastStep_deg;) {
      const Frame frame = Frame::from_z(d);
      const double before = best;
      for (int k = 0; k < 6; ++k) {
        const double turn = std::numbers::pi / 3.0 * k + 20.0 * step, far = radians(step);
        const Vec3 to = std::cos(turn) * frame.ex() + std::sin(turn) * frame.ey();
        const Direction next = Direction::from(std::cos(far) * frame.ez() + std::sin(far) * to);
        const double here = cd(next, 4096);
        if (here <= best) continue;
        best = here;
        d = next;
      }
      if (best <= before) step *= 0.5;
    }
    return {best, d};
  }

  /// From a coarse circle to a finer one about the ends, then a straight line through points about each.
  std::optional<Estimate> arc_deg(double c_deg, std::vector<CirclePoint> circle,
                                  const Estimate& level) const {
    const auto coarse = smallest_arc(circle, level.mean);
    if (!coarse) return std::nullopt;
    for (const double end : {coarse->from_deg, coarse->to_deg}) {
      for (double off = -0.3; off < 0.3; off += 0.02) {
        const double angle = end + off - 360.0 * std::floor((end + off) / 360.0);
        circle.push_back({angle, cd(at(c_deg, angle), 1024)});
      }
    }
    std::sort(circle.begin(), circle.end(),
              [](const CirclePoint& a, const CirclePoint& b) { return a.angle_deg < b.angle_deg; });
    const auto fine = smallest_arc(circle, level.mean);
    const Line from = crossing(c_deg, fine->from_deg, level.mean),
               to = crossing(c_deg, fine->to_deg, level.mean);
    const double by_level = level.standard_error * (1.0 / std::abs(from.slope) + 1.0 / std::abs(to.slope));
    return Estimate{to.angle_deg - from.angle_deg, std::hypot(by_level, from.error_deg, to.error_deg)};
  }

  struct Line {
    double angle_deg, slope, error_deg;
    bool bends;
  };

  /// Of a straight line through points about it, which are nearer to each other where the section bends by
  /// more than their noise. It moves no further than its points reach.
  Line crossing(double c_deg, double angle_deg, double level) const {
    double step_deg = 0.016;
    Line line = crossing(c_deg, angle_deg, level, step_deg, 1024);
    for (int k = 0; k < 20; ++k) {
      const double before_deg = line.angle_deg;
      line = crossing(c_deg, before_deg, level, step_deg, 8192);
      if (std::abs(line.angle_deg - before_deg) > 2.9 * step_deg) continue;
      if (!line.bends) break;
      step_deg = std::max(0.5 * step_deg, kNearest_deg);
    }
    return line;
  }

  Line crossing(double c_deg, double angle_deg, double level, double step_deg, std::uint64_t samples) const {
    constexpr int kPoints = 7;
    std::array<double, kPoints> y{};
    double sum = 0.0, across = 0.0, squares = 0.0, rest = 0.0, noise = 0.0;
    for (int k = 0; k < kPoints; ++k) {
      const double x = step_deg * (k - kPoints / 2);
      const Estimate e = backward_.intensity_cd(at(c_deg, angle_deg + x), samples, 16, kSeed);
      y[static_cast<std::size_t>(k)] = e.mean;
      noise += e.standard_error * e.standard_error;
      sum += e.mean;
      across += x * e.mean;
      squares += x * x;
    }
    const double mean = sum / kPoints, slope = across / squares;
    for (int k = 0; k < kPoints; ++k)
      rest += std::pow(y[static_cast<std::size_t>(k)] - mean - slope * step_deg * (k - kPoints / 2), 2.0);
    return {angle_deg + std::clamp((level - mean) / slope, -3.0 * step_deg, 3.0 * step_deg), slope,
            std::sqrt(rest / (kPoints - 2) / kPoints) / std::abs(slope), rest > kBends * noise};
  }

  BackwardEstimator backward_;
  Lines lines_;
};

std::vector<Direction> directions(const std::string& file) {
  std::vector<Direction> out;
  std::ifstream in(file);
  constexpr std::string_view kMark = ",direction,";
  for (std::string line; std::getline(in, line);) {
    const auto found = line.find(kMark);
    if (found == std::string::npos) continue;
    std::istringstream words(line.substr(found + kMark.size()));
    double x = 0.0, y = 0.0, z = 0.0;
    if (words >> x >> y >> z) out.push_back(Direction::from({x, y, z}));
  }
  return out;
}

void print_truth(const Scene& scene, const std::string& name, std::uint64_t rays, const std::string& runs) {
  const Lines lines(name, 0);
  constexpr std::uint64_t kTruthSeed = 987'654;
  const TraceResult result = trace(scene, {.last_ray = rays, .seed = kTruthSeed});
  print_fluxes(far_field_metrics(counted_far_field(result, 0), {}, {}), lines);
  const Truth truth(scene, lines);
  const Estimate peak = truth.peak(directions(runs)), axis = truth.axis();
  for (const double c : kPlanes_deg) truth.section(c, peak, axis);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv, argv + argc);
  const bool runs = argc >= 6 && words[1] == "runs", truth = argc == 5 && words[1] == "truth";
  if (!runs && !truth) {
    fmt::print(stderr,
               "usage: bench_coverage runs PROJECT.toml RAYS FIRST_SEED LAST_SEED [counted]\n"
               "       bench_coverage truth PROJECT.toml RAYS RUNS.csv\n");
    return 2;
  }
  const Scene scene = read_project(words[2]).scene;
  const std::string name = std::filesystem::path(words[2]).stem().string();
  const auto rays = static_cast<std::uint64_t>(std::stod(words[3]));
  if (truth) {
    print_truth(scene, name, rays, words[4]);
    return 0;
  }
  for (std::uint64_t seed = std::stoull(words[4]); seed <= std::stoull(words[5]); ++seed)
    print_run(scene, name, rays, seed, argc > 6 && words[6] == "counted");
}
