// SPDX-License-Identifier: Apache-2.0
// Designs of lenses by design() itself.
//   bench_lenses hidden [N [SECONDS [RAYS]]]  light of random lenses of 20 parameters, tables of RAYS (2^25)
//   bench_lenses free [N [SECONDS [RAYS]]]    the same of faces of 100 parameters without symmetry (60 s)
//   bench_lenses oval [SECONDS]               a free form for 60 x 30 degrees from a disk of 1 mm
//   bench_lenses collimator [SECONDS]         a TIR collimator for the dies of `make-source led`, 10 degrees
// Lines of `hidden` and `free`: error in 48 x 48 boxes (noise taken out) of the result, by 4 M rays that no
// design has had, that of the exact lens against its own table by as many, what the design itself found for
// its result and for the start, efficiency, and how it ended.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/design/lens/lens_validation.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/design/validation/error_boxes.h"
#include "lucerna/random.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

namespace {

using namespace lucerna;

using Corners = std::vector<OutlinePoint>;

constexpr int kPieces = 19;

std::string outline_text(const Corners& corners) {
  std::string out = "outline_mm = [";
  for (const OutlinePoint& c : corners) out += fmt::format("[{}, {}], ", c[0] + 0.0, c[1] + 0.0);
  return out + "]\n";
}

/// A disk of 1 mm under a lens with a flat face below and a dome above.
LensShape dome() {
  Corners corners{{0.0, 3.0}, {14.0, 3.0}};
  for (int i = 0; i <= kPieces; ++i) {
    const double r = 14.0 * (1.0 - static_cast<double>(i) / kPieces);
    corners.push_back({i == kPieces ? 0.0 : r, 6.0 + 5.0 * (1.0 - r * r / 196.0)});
  }
  const std::vector<std::size_t> free{2};
  return {corners, 20.0, free, 0};
}

/// The dome with six waves of up to `size_mm` each on it.
LensShape random_lens(std::uint64_t seed, double size_mm) {
  const LensShape plain = dome();
  const auto n = static_cast<Eigen::Index>(plain.parameter_count());
  for (std::uint64_t attempt = 0;; ++attempt) {
    Rng rng(seed, attempt);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(n);
    for (int wave = 0; wave < 6; ++wave) {
      const double high = size_mm * (2.0 * rng.uniform() - 1.0) / (1.0 + 0.3 * wave * wave);
      for (Eigen::Index i = 0; i < n; ++i)
        p[i] +=
            high * std::cos(std::numbers::pi * wave * static_cast<double>(i) / static_cast<double>(n - 1));
    }
    LensShape shape = plain.with(p);
    if (shape.is_valid()) return shape;
  }
}

/// What a kind of hidden lens has in its project.
struct LensKind {
  const char* detector;
  const char* design;
};
constexpr LensKind kRevolution{"c_step_deg = 360\ngamma_step_deg = 0.1\n", ""};
constexpr LensKind kFreeForm{"c_step_deg = 2.5\ngamma_step_deg = 0.5\n", "family = \"bspline\"\n"};

std::string project_of(const LensShape& lens, const LensKind& kind, double seconds) {
  std::size_t side = 0;
  for (const LensFace& face : lens.form().faces) {
    if (face.is_free) side = face.run.from;
  }
  return "[[source]]\nkind = \"disk\"\nradius_mm = 0.5\n[[body]]\nrole = \"solid\"\nrefractive_index = "
         "1.49\n" +
         outline_text(lens.corners()) +
         fmt::format(
             "[[detector]]\nname = \"far\"\nkind = \"far-field\"\n{}[target]\nfile = "
             "\"hidden.ldt\"\n[design]\nfree_sides = {}\ntime_s = {}\n{}",
             kind.detector, side, seconds, kind.design);
}

std::shared_ptr<const IntensityDistribution> light_of(const Project& project, std::uint64_t rays) {
  TraceOptions options;
  options.seed = 4711;
  options.last_ray = rays;
  const TraceResult traced = trace(project.scene, options);
  return std::make_shared<const IntensityDistribution>(
      trace_metrics(traced, project.scene).far_fields.front().intensity.distribution);
}

/// The exact lens number `k` of a kind.
Project exact_lens(int k, const LensKind& kind, const ProjectMemory& memory) {
  const std::uint64_t seed = 100 + static_cast<std::uint64_t>(k);
  if (&kind == &kRevolution)
    return parse_project(project_of(random_lens(seed, 0.4), kind, 1.0), "hidden.toml", memory);
  const LensProblem plain =
      lens_problem(parse_project(project_of(dome(), kind, 1.0), "hidden.toml", memory), "hidden.toml");
  constexpr int kIntervals = 7;
  const DesignShape truth = perturbed(face_of(plain.start, kIntervals), 0.4, Rng(seed, 0));
  return with_lens(plain, {plain.start, truth});
}

void hidden(const LensKind& kind, int count, double seconds, std::uint64_t table_rays) {
  std::vector<double> errors;
  for (int k = 0; k < count; ++k) {
    ProjectMemory memory;
    memory.targets["hidden.ldt"] =
        std::make_shared<const IntensityDistribution>(uniform_distribution(1.0, 1.0));
    const Project exact = exact_lens(k, kind, memory);
    memory.targets["hidden.ldt"] = light_of(exact, table_rays);
    const std::string text = project_of(dome(), kind, seconds);
    const LensProblem problem = lens_problem(parse_project(text, "hidden.toml", memory), "hidden.toml");
    const ErrorBoxes boxes(target_rectangle(problem.target));
    const auto error_of = [&](const Scene& scene) {
      constexpr std::uint64_t kSeed = 9, kRays = std::uint64_t{1} << 22;
      return validate_lens(scene, LensSurface::exact, boxes,
                           box_target(boxes, problem.target, total_flux(exact.scene.sources)),
                           TargetMode::shape, kSeed, kRays)
          .error.c48;
    };
    const BoxErrorEstimate own = error_of(exact.scene);
    const auto begin = std::chrono::steady_clock::now();
    const DesignedMirror found = design(parse_project(text, "hidden.toml", memory), "hidden");
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const BoxErrorEstimate &e = found.error.c48, &start = found.start_error.c48;
    const BoxErrorEstimate again = error_of(parse_project(found.project_text, "found.toml", memory).scene);
    errors.push_back(again.excess);
    fmt::print(
        "{:3} error {:.3f} +- {:.3f} % (exact lens {:.3f} +- {:.3f} %), by the design {:.3f} +- {:.3f} % "
        "(start {:.2f} %), efficiency {:.4f}, {} evaluations, {:.0f} M rays, {:.1f} s, {}\n",
        k, 100.0 * again.excess, 100.0 * again.standard_error, 100.0 * own.excess, 100.0 * own.standard_error,
        100.0 * e.excess, 100.0 * e.standard_error, 100.0 * start.excess, found.efficiency.mean,
        found.evaluations, 1e-6 * static_cast<double>(found.rays), took, to_string(found.end));
    std::fflush(stdout);
  }
  std::sort(errors.begin(), errors.end());
  fmt::print("median {:.3f} %, worst {:.3f} %\n", 100.0 * errors[errors.size() / 2], 100.0 * errors.back());
}

/// Gaussian beam whose full width at half the maximum is `width_deg`.
IntensityDistribution beam(double width_deg) {
  IntensityDistribution out = uniform_distribution(0.25, 1.0);
  out.c_deg = {0.0};
  out.cd.assign(out.gamma_deg.size(), 0.0);
  for (std::size_t g = 0; g < out.gamma_deg.size(); ++g) {
    const double x = (180.0 - out.gamma_deg[g]) / (0.5 * width_deg);
    out.cd[g] = std::exp(-std::numbers::ln2 * x * x);
  }
  return out;
}

/// The same of 60 degrees along C0 and 30 across.
IntensityDistribution oval_beam() {
  IntensityDistribution out = uniform_distribution(5.0, 1.0);
  const std::size_t rows = out.gamma_deg.size();
  for (std::size_t c = 0; c < out.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < rows; ++g) {
      const double off = 180.0 - out.gamma_deg[g], steep = off < 90.0 ? std::tan(radians(off)) : 0.0;
      const double x = degrees(std::atan(steep * std::cos(radians(out.c_deg[c])))) / 30.0;
      const double y = degrees(std::atan(steep * std::sin(radians(out.c_deg[c])))) / 15.0;
      out.cd[c * rows + g] = off < 90.0 ? std::exp(-std::numbers::ln2 * (x * x + y * y)) : 0.0;
    }
  }
  return out;
}

void print(const char* what, const DesignedMirror& found) {
  const BoxErrorEstimate &e = found.error.c48, &start = found.start_error.c48;
  fmt::print(
      "{}: error {:.2f} +- {:.2f} % (start {:.2f} %), {:.1f} % of the light in the rectangle, "
      "efficiency {:.4f} with Fresnel, {} evaluations, {}\n",
      what, 100.0 * e.excess, 100.0 * e.standard_error, 100.0 * start.excess,
      100.0 * found.error.in_rectangle.mean, found.efficiency.mean, found.evaluations, to_string(found.end));
  const auto& peak = found.light.far_fields.front().metrics.peak;
  if (peak) fmt::print("peak {:.0f} +- {:.0f} cd\n", peak->cd.mean, peak->cd.standard_error);
  for (const LimitCheck& c : found.limits)
    fmt::print("limit {}: {:.4g} found, {:.4g} allowed, {}\n", c.limit, c.found.mean, c.allowed,
               c.held ? "held" : "NOT HELD");
}

void oval(double seconds) {
  const std::string text = fmt::format(R"([[source]]
kind = "disk"
radius_mm = 0.5
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 3], [14, 3], [14, 6], [12.6, 7], [9.8, 8.55], [7, 9.75], [4.2, 10.55], [1.4, 10.95],
  [0, 11]]
[[detector]]
kind = "far-field"
[target]
file = "beam.ldt"
[design]
family = "bspline"
free_sides = 2
time_s = {}
[design.limits]
max_height_mm = 14
min_thickness_mm = 1.0
)",
                                       seconds);
  ProjectMemory memory;
  memory.targets["beam.ldt"] = std::make_shared<const IntensityDistribution>(oval_beam());
  print("oval", design(parse_project(text, "oval.toml", memory), "oval"));
}

void collimator(double seconds) {
  // The outline of examples/tir-collimator.toml, 1.4 times as large: the dome over the dies has 2.8 mm.
  const std::string text = fmt::format(R"([[source]]
kind = "led"
position_mm = [0, 0, 0]
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 6.5], [4, 5.2], [4.4, 0.2], [5.4, 0.2], [9, 5], [13, 11.5], [16, 18], [16.2, 19.5],
  [0, 19.5]]
smooth_below_deg = 30
[[detector]]
name = "far"
kind = "far-field"
gamma_step_deg = 0.5
[target]
file = "beam.ldt"
[design]
free_sides = [0, 1, 3, 7]
intervals = 6
time_s = {}
[design.limits]
max_height_mm = 22
max_diameter_mm = 34
min_thickness_mm = 1.0
min_draft_deg = 1.0
)",
                                       seconds);
  ProjectMemory memory;
  memory.targets["beam.ldt"] = std::make_shared<const IntensityDistribution>(beam(10.0));
  print("collimator", design(parse_project(text, "collimator.toml", memory), "collimator"));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const auto number = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
  if (what == "hidden" || what == "free") {
    const bool is_free = what == "free";
    hidden(is_free ? kFreeForm : kRevolution, static_cast<int>(number(2, 10)),
           number(3, is_free ? 60.0 : 20.0), static_cast<std::uint64_t>(number(4, 33554432.0)));
  } else if (what == "oval") {
    oval(number(2, 60.0));
  } else if (what == "collimator") {
    collimator(number(2, 60.0));
  } else {
    fmt::print("usage: bench_lenses hidden|free [N [SECONDS [RAYS]]] | oval|collimator [SECONDS]\n");
    return 2;
  }
  return 0;
}
