// SPDX-License-Identifier: Apache-2.0
// What each way to look for a mirror reaches in the same processor time, on targets of the trade; the
// optimizers of a project through design(), searches alone by themselves:
//   bench_optimizers PHOTOMETRY_DIR [--seconds S] [--source led|filament|FILE] [case ...]
// Each row: relative RMS in 48 x 48 tent bins (48 rings) and efficiency, re-traced with 1 M other rays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/fit/continuation_schedule.h"
#include "lucerna/design/initial/initial_guesses.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/search/optimizer.h"

using namespace lucerna;

namespace {

struct Case {
  std::string name, target, mirror;
};

constexpr const char* kRound =
    "family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 12\ndiameter_mm = 80\n";
constexpr const char* kFree =
    "family = \"bspline\"\nfocal_mm = 12\naperture = \"rectangle\"\nsize_mm = [80, 80]\n";

std::vector<Case> cases(const std::string& folder) {
  const auto file = [&](const char* name) { return fmt::format("file = \"{}/{}\"\n", folder, name); };
  const char* map =
      "kind = \"plane\"\nposition_mm = [0, 0, -2000]\nnormal = \"+z\"\nsize_mm = [2000, 1200]\n"
      "file = \"uniform.csv\"\n";
  return {
      {"spot", file("ledvance_4058075580664_FL_MAX_LUM_1200W_757_SYM_10_WAL.ldt"), kRound},
      {"batwing", file("zumtobel_tecton_c_42927033.ldt"), kRound},
      {"wall-washer", file("ledvance_4058075580657_FL_MAX_LUM_900W_757_ASYM_50X110_WAL.ldt"), kFree},
      {"street", file("ers_OutdoorRoadway_60W_4000K.ies"), kFree},
      {"rectangle", map, kFree},
  };
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct OutOfTime {};

constexpr double kNoLimit = 1e9;

/// What a way begins with.
struct Task {
  const DesignProblem& problem;
  FitProblem fit;
  double seconds;
};

/// One way's shape after the task's seconds of processor time.
using Way = std::function<DesignShape(const Task&)>;

DesignShape by_search(GlobalMethod method, const Task& task) {
  const double from = cpu_seconds();
  const FitProblem& problem = task.fit;
  // As the thesis would: about the given mirror, all knots that the search can take, to the end of the time.
  const DesignShape& given = task.problem.start;
  const SearchSpace space = search_space(given, continuation_schedule(given, problem.bins, {}));
  const TentBins bins = rebinned(problem.bins, 1.0, problem.bins.count() / 3);
  const Eigen::VectorXd target = problem.target(bins);
  constexpr std::uint64_t kRays = std::uint64_t{1} << 15;
  problem.rays->grow(kRays);
  Eigen::VectorXd best = space.shape.parameters();
  double min = 1e300;
  try {
    global_search(method, space.box, {problem.seed, 1000000},
                  [&](const std::vector<Eigen::VectorXd>& points) {
                    if (cpu_seconds() - from > task.seconds) throw OutOfTime();
                    std::vector<double> costs(points.size());
                    parallel_blocks(points.size(), 1, [&](std::size_t i, std::size_t) {
                      costs[i] = fit_cost(problem, space.shape.with(points[i]), bins, target, kRays);
                    });
                    for (std::size_t i = 0; i < points.size(); ++i) {
                      if (!(costs[i] < min)) continue;
                      min = costs[i];
                      best = points[i];
                    }
                    return costs;
                  });
  } catch (const OutOfTime&) {
  }
  return space.shape.with(best);
}

/// Asks to stop when a design has had its processor seconds.
class ProcessorTime final : public Progress {
 public:
  explicit ProcessorTime(double seconds) : end_(cpu_seconds() + seconds) {}
  void update(std::string_view, std::uint64_t, std::uint64_t) override {}
  bool stop_requested() const override { return cpu_seconds() > end_; }

 private:
  double end_;
};

/// What a user gets who names this optimizer.
DesignShape by_design(const char* name, DesignProblem problem, double seconds) {
  problem.optimizer = optimizer(name);
  DesignOptions options;
  options.time_s = kNoLimit;
  options.validation_rays = std::uint64_t{1} << 18;  // judged below
  ProcessorTime time(seconds);
  return design(problem, options, time).shape;
}

std::vector<std::pair<std::string, Way>> ways() {
  std::vector<std::pair<std::string, Way>> out;
  out.emplace_back("given mirror", [](const Task& t) { return t.problem.start; });
  out.emplace_back("zero-etendue", [](const Task& t) {
    for (const InitialGuess& start : initial_guesses(t.fit, t.problem.start)) {
      if (start.entry == InitialKnots::own_knots) return start.shape;  // the cheapest of a point source's
    }
    return t.problem.start;
  });
  for (const GlobalMethod m :
       {GlobalMethod::tree, GlobalMethod::annealing, GlobalMethod::direct, GlobalMethod::cma_es}) {
    out.emplace_back(fmt::format("{} alone", to_string(m)), [m](const Task& t) { return by_search(m, t); });
  }
  for (const char* name : {"least-squares", "tree", "cma-es", "auto"}) {
    out.emplace_back(name, [name](const Task& t) { return by_design(name, t.problem, t.seconds); });
  }
  return out;
}

void run(const Case& c, const std::string& source, double seconds, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "project.toml";
  write_file(path, fmt::format("[[source]]\n{}\n[[reflector]]\n{}position_mm = [0, 0, 12]\naxis = \"-z\"\n"
                               "reflectance = 0.9\n[target]\n{}mode = \"shape\"\n[design]\n",
                               source, c.mirror, c.target));
  const DesignProblem problem = design_problem(read_project(path), path);
  const DesignOptions options;
  DesignRays validation(problem.project.scene.sources, problem.world_from_mirror.inverse(), 4711);
  validation.grow(1 << 20);
  for (const auto& [name, way] : ways()) {
    DesignRays rays(problem.project.scene.sources, problem.world_from_mirror.inverse(), options.seed);
    const FitProblem fit = fit_problem(problem, options, rays);
    const double from = cpu_seconds();
    const DesignShape shape = way({problem, fit, seconds});
    const double took = cpu_seconds() - from;
    EvaluationOptions plain;
    plain.rays = 1 << 20;
    plain.derivatives = false;
    const Evaluation e = evaluate(shape, problem.reflectance, validation, fit.bins, plain);
    const BinError error = bin_error(e, fit.target(fit.bins), fit.bins, fit.mode);
    fmt::print(
        "{:12} {:16} error {:6.2f} %  noise {:5.2f} %  efficiency {:.3f}  in window {:.3f}  {:6.1f} s\n",
        c.name, name, 100.0 * error.relative_rms, 100.0 * error.floor, e.reflected + e.direct, e.flux.sum(),
        took);
    std::fflush(stdout);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr,
               "bench_optimizers PHOTOMETRY_DIR [--seconds S] [--source led|filament|FILE] [case ...]\n");
    return 2;
  }
  double seconds = 20.0;
  std::string source = "kind = \"led\"\n";
  std::vector<std::string> names;
  for (int i = 2; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--seconds" && i + 1 < argc) {
      seconds = std::stod(argv[++i]);
    } else if (a == "--source" && i + 1 < argc) {
      const std::string kind = argv[++i];
      source = kind == "led" || kind == "filament" ? fmt::format("kind = \"{}\"\n", kind)
                                                   : fmt::format("file = \"{}\"\n", kind);
    } else {
      names.push_back(a);
    }
  }
  // An LED looks into the mirror, up; a filament lies across.
  source += source.find("filament") == std::string::npos ? "axis = \"+z\"\n" : "surface = \"none\"\n";
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("lucerna-bench-{}", std::clock());
  std::filesystem::create_directories(folder);
  write_file(folder / "uniform.csv", "1,1\n1,1\n");
  for (const Case& c : cases(std::filesystem::absolute(argv[1]).string())) {
    if (names.empty() || std::find(names.begin(), names.end(), c.name) != names.end()) {
      run(c, source, seconds, folder);
    }
  }
  std::filesystem::remove_all(folder);
}
