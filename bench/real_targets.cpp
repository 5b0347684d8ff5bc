// SPDX-License-Identifier: Apache-2.0
// Designs as the command line makes them, each validated by fresh rays through the mesh of the mirror:
//   bench_real_targets [options] files FILE.ldt|FILE.ies ...   real targets, for an LED (or --source FILE)
//   bench_real_targets [options] synthetic [NAME ...]          the functions of synthetic_targets.h
//   bench_real_targets [options] attainable [NAME ...]         the light of mirrors designed for these once
//   bench_real_targets [options] hidden [CASE ...]             random mirrors: n10, n49-near, n49-far,
//   n49-wild, n400
// options: --time S (60), --rays N (of the validation, 16 M), --target-rays N (of tables, 64 M), --family
// bspline|revolution, --light-weight W (0.1), --source led|filament|FILE (led; `attainable`: both in turn),
// --targets N (of `hidden`, 10), --seed S, --start (judges only the mirror to begin with), --history (prints
// every step), --keep (the models and tables that were made), --fixed-knots (of `hidden`), --mirrors FOLDER
// (of `attainable`, bench/attainable: mirrors and models; what is missing is made and kept), --slope DEG
// (largest angle between facets and surface in the validation; default: the design's own), --device cuda. The
// mirror of all but `hidden`: 120 mm over f = 20 mm, hole 8 mm, reflectance 0.9. Each line: excess at n = 12,
// 24 and 48 with its standard error, noise, light in the rectangle, light and error outside, bound, seconds
// of the design and of the validation, rays of the design, why it ended. Each mode ends with a table of its
// results, excess at n = 48 in per cent unless another n stands there.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/run/design_metrics.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/design/validation/bounds.h"
#include "lucerna/design/validation/validation.h"
#include "lucerna/photometric_file.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source_model.h"
#include "lucerna/trace.h"
#include "lucerna/trace/device/accelerator.h"
#include "synthetic_targets.h"

using namespace lucerna;
namespace fs = std::filesystem;

namespace {

struct Run {
  double time_s = 60.0, light_weight = kLightWeight;
  std::uint64_t rays = std::uint64_t{1} << 24, target_rays = std::uint64_t{1} << 26, seed = 1;
  std::string family = "bspline", source, mode;
  int targets = 10;
  std::optional<double> slope_deg;
  bool start_only = false, history = false, keep = false, fixed_knots = false;
  std::vector<std::string> names;
  fs::path folder, mirrors = "bench/attainable";
  std::shared_ptr<Accelerator> device;
};

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

bool selected(const Run& run, const std::string& name) {
  return run.names.empty() || std::find(run.names.begin(), run.names.end(), name) != run.names.end();
}

/// A model of an emitter, as `make-source -n 1e6` and `compress` make it.
fs::path model_of(const Run& run, const std::string& source) {
  if (fs::exists(source)) return fs::absolute(source);
  fs::path file = run.folder / (source + ".nfl");
  if (fs::exists(file)) return file;
  EmitterOptions options;
  options.kind = emitter_kind(source);
  const auto emitter = make_emitter(options);
  RaySet rays;
  rays.header.flux_unit = emitter->flux_unit();
  rays.header.flux_lm = emitter->flux();
  rays.rays.resize(1'000'000, 0);
  emitter->emit(Sequence(SequenceKind::random, 1), 0, rays.rays);
  save_source_model(file, *compress_adaptive(rays, {}));
  return file;
}

/// A table in Markdown, printed when all its rows are known.
class Table {
 public:
  explicit Table(std::string head) : lines_{std::move(head)} {
    std::string rule = "|";
    for (std::size_t bars = std::ranges::count(lines_[0], '|'); bars > 1; --bars) rule += "---|";
    lines_.push_back(std::move(rule));
  }
  template <class... T>
  void row(fmt::format_string<T...> format, T&&... values) {
    lines_.push_back(fmt::format(format, std::forward<T>(values)...));
  }
  void print() const { fmt::print("\n{}\n", fmt::join(lines_, "\n")); }

 private:
  std::vector<std::string> lines_;
};

std::string source_toml(const fs::path& model) {
  return fmt::format("[[source]]\nfile = \"{}\"\n", model.string());
}

/// The source and the plain paraboloid.
std::string luminaire(const Run& run, const fs::path& model) {
  return source_toml(model) +
         fmt::format(
             "[[reflector]]\nfamily = \"{}\"\n{}focal_mm = 20.0\ndiameter_mm = 120.0\nhole_diameter_mm = "
             "8.0\nposition_mm = [0, 0, 20]\naxis = \"-z\"\nreflectance = 0.9\n",
             run.family, run.family == "revolution" ? "preset = \"parabola\"\n" : "");
}

std::string own_luminaire(const Run& run) {
  return luminaire(run, model_of(run, run.source.empty() ? "led" : run.source));
}

DesignProblem problem(const Run& run, const std::string& scene, const fs::path& target,
                      const std::string& mode) {
  const fs::path file = run.folder / "project.toml";
  write_file(file, fmt::format("{}[target]\nfile = \"{}\"\nmode = \"{}\"\n[design]\nlight_weight = {}\n",
                               scene, fs::absolute(target).string(), mode, run.light_weight));
  return design_problem(read_project(file), file);
}

/// What independent rays say of a shape.
struct Validated {
  Validation validation;
  DesignBound bound;
  const DesignError& error() const { return validation.error; }
};

/// "0.24 +- 0.03", per cent.
std::string percent(const BoxErrorEstimate& e) {
  return fmt::format("{:.2f} +- {:.2f}", 100.0 * e.excess, 100.0 * e.standard_error);
}

Validated validated(const Run& run, const DesignProblem& p, const DesignShape& shape) {
  Scene scene = p.project.scene;
  scene.reflectors.front().reflector = shape.reflector();
  const ErrorBoxes boxes(target_rectangle(p.target));
  DesignRays rays(scene.sources, p.world_from_mirror.inverse(), 4711);
  rays.grow(std::uint64_t{1} << 18);
  const auto target = box_target(boxes, p.target, rays.flux());
  ValidationOptions options;
  options.seed = run.seed + 1000;
  options.max_rays = run.rays;
  if (run.slope_deg) options.tolerance = CadTolerance{.slope_deg = *run.slope_deg};
  Validated out{validate(scene, boxes, target, p.target.mode, options), {}};
  SourceEtendue etendue(rays);
  out.bound =
      design_bound(boxes, target, p.target.mode, out.validation, etendue, shape, p.world_from_mirror.ez());
  return out;
}

void print_line(const std::string& name, const Validated& j, const std::string& end) {
  const DesignError& e = j.validation.error;
  const auto of = [](const BoxErrorEstimate& x) {
    return fmt::format("{:6.2f}+-{:.2f}", 100.0 * x.excess, 100.0 * x.standard_error);
  };
  fmt::print(
      "{:28} 12/24/48 {} {} {} %  noise {:.2f}  in {:.4f}  outside {:.4f} (direct {:.4f}) error {:6.2f}  "
      "bound "
      "{:.2f}  {}  validated in {:.1f} s (mesh {:.2f} s, {} triangles), {:.1f} M rays\n",
      name, of(e.c12), of(e.c24), of(e.c48), 100.0 * e.c48.floor, e.in_rectangle.mean, e.outside_share.mean,
      e.outside_direct.mean, 100.0 * e.outside.excess, 100.0 * j.bound.error, end, j.validation.seconds,
      j.validation.mesh_s, j.validation.triangles, 1e-6 * static_cast<double>(j.validation.rays));
  std::fflush(stdout);
}

/// Designs, validates and prints; the shape that was found.
DesignShape solve(const Run& run, const std::string& name, const DesignProblem& p, double time_s,
                  Validated& out) {
  DesignOptions options;
  options.time_s = time_s;
  options.seed = run.seed;
  options.validation_rays = std::uint64_t{1} << 18;  // the validation below has more
  options.accelerator = run.device;
  const auto clock = std::chrono::steady_clock::now();
  DesignResult result(p.start);
  const auto observer = [&](const FitRecord& r, const DesignShape&, const std::string&) {
    if (!run.history) return;
    fmt::print(
        "  {:6.2f} s  candidate {} stage {} step {}  {} rays  error {:.5f}  noise {:.5f}  lambda {:.2g} {}  "
        "in {:.4f}\n",
        seconds_since(clock), r.candidate, r.stage, r.step, r.rays, r.error, r.floor, r.lambda,
        r.accepted ? "taken" : "refused", r.in_rectangle);
  };
  if (!run.start_only) result = design(p, options, no_progress(), observer);
  const double seconds = seconds_since(clock);
  out = validated(run, p, result.shape);
  print_line(name, out,
             fmt::format("designed in {:.1f} s, {} evaluations, {:.1f} M rays ({})", seconds,
                         result.evaluations, 1e-6 * static_cast<double>(result.rays), to_string(result.end)));
  return result.shape;
}

/// The far field of a scene as a table.
IntensityDistribution traced_table(Scene scene, double c_step_deg, double gamma_step_deg,
                                   std::uint64_t rays) {
  FarFieldDetector detector;
  detector.c_step_deg = c_step_deg;
  detector.gamma_step_deg = gamma_step_deg;
  scene.far_fields = {detector};
  scene.planes.clear();
  TraceOptions options;
  options.last_ray = rays;
  options.seed = 31;
  return trace_metrics(trace(scene, options)).far_fields.front().intensity.distribution;
}

fs::path written(const Run& run, const std::string& name, const IntensityDistribution& table) {
  PhotometricFile file;
  file.distribution = table;
  fs::path path = run.folder / (name + ".ldt");
  write_photometric_file(path, file, PhotometricFormat::ldt);
  return path;
}

/// Head and row of a table of targets.
Table target_table() { return Table("| target | n = 12 | n = 24 | n = 48 | bound | light |"); }
void add_row(Table& table, const std::string& name, const Validated& j) {
  const DesignError& e = j.error();
  table.row("| {} | {:.2f} | {:.2f} | {} | {:.2f} | {:.3f} |", name, 100.0 * e.c12.excess,
            100.0 * e.c24.excess, percent(e.c48), 100.0 * j.bound.error, e.in_rectangle.mean);
}

void files(const Run& run) {
  Table table = target_table();
  for (const std::string& file : run.names) {
    Validated j;
    const std::string name = fs::path(file).filename().string().substr(0, 28);
    solve(run, name, problem(run, own_luminaire(run), file, "shape"), run.time_s, j);
    add_row(table, name, j);
  }
  table.print();
}

void synthetic(const Run& run) {
  Table table = target_table();
  for (const auto& target : bench::synthetic_targets()) {
    if (!selected(run, target.name)) continue;
    const fs::path file = written(run, target.name, bench::table_of(target, 2.5, 1.0));
    Validated j;
    solve(run, target.name, problem(run, own_luminaire(run), file, "shape"), run.time_s, j);
    add_row(table, target.name, j);
  }
  table.print();
}

/// The model of a source in the folder of mirrors.
fs::path fixed_model(const Run& run, const std::string& source) {
  if (fs::exists(source)) return model_of(run, source);
  fs::create_directories(run.mirrors);
  fs::path file = fs::absolute(run.mirrors / (source + ".nfl"));
  if (!fs::exists(file)) fs::copy_file(model_of(run, source), file);
  return file;
}

/// The mirror of that name in the folder of mirrors, its coefficients in whole nanometres.
fs::path fixed_mirror(const Run& run, const std::string& name, const bench::SyntheticTarget& target,
                      const fs::path& model) {
  fs::path file = run.mirrors / (name + ".toml");
  if (fs::exists(file)) return file;
  const fs::path table = written(run, name, bench::table_of(target, 2.5, 1.0));
  const DesignProblem p = problem(run, luminaire(run, model), table, "shape");
  Validated j;
  const DesignShape made = solve(run, name + " made", p, run.time_s, j);
  const Eigen::VectorXd rounded = (1e6 * made.parameters()).array().round() / 1e6;
  write_file(file, reflector_toml(p, made.with(rounded)));
  return file;
}

/// Designs for the light of mirrors that were themselves designed for a function.
void attainable(const Run& run) {
  double worst = -1.0;
  Table table("| source | target | exact mirror | from scratch | above | light, exact | light, found |");
  const std::vector<std::string> both{"led", "filament"};
  for (const std::string& source : run.source.empty() ? both : std::vector{run.source}) {
    const fs::path model = fixed_model(run, source);
    for (const auto& target : bench::synthetic_targets()) {
      if (!selected(run, target.name)) continue;
      const std::string name = target.name + "-" + fs::path(source).stem().string();
      const std::string mirror =
          source_toml(model) + read_file(fixed_mirror(run, name, target, model), 1 << 20);
      const fs::path own = run.folder / (name + ".toml");
      write_file(own, mirror);
      const fs::path light =
          written(run, name, traced_table(read_project(own).scene, 2.5, 1.0, run.target_rays));
      const DesignProblem known = problem(run, mirror, light, "shape");
      const Validated exact = validated(run, known, known.start);
      print_line(name + " exact", exact, "not designed");
      Validated again;
      solve(run, name, problem(run, luminaire(run, model), light, "shape"), run.time_s, again);
      const double above = again.error().c48.excess - exact.error().c48.excess;
      fmt::print("{:28} above the exact mirror at n = 48: {:.2f} %\n", name, 100.0 * above);
      worst = std::max(worst, above);
      table.row("| {} | {} | {} | {} | {:.2f} | {:.3f} | {:.3f} |", source, target.name,
                percent(exact.error().c48), percent(again.error().c48), 100.0 * above,
                exact.error().in_rectangle.mean, again.error().in_rectangle.mean);
    }
  }
  fmt::print("worst above the exact mirror: {:.2f} %\n", 100.0 * worst);
  table.print();
}

/// Random mirrors about a paraboloid: coefficients uniform in +- size_mm, of those that throw light as far
/// from the paraboloid's as low and high say (relative RMS of reflected light in 48 x 48 tents).
struct Suite {
  std::string name;
  bool revolution;
  int intervals;
  double size_mm, low, high, bar, seconds;
};

const std::vector<Suite> kSuites{{"n10", true, 8, 1.0, 0.25, 0.5, 0.005, 10.0},
                                 {"n49-near", false, 4, 0.5, 0.05, 0.15, 0.005, 5.0},
                                 {"n49-far", false, 4, 2.0, 0.25, 0.5, 0.01, 20.0},
                                 {"n49-wild", false, 4, 5.0, 0.5, 10.0, 0.015, 20.0},
                                 {"n400", false, 17, 2.0, 0.0, 10.0, 0.02, 60.0}};

DesignShape plain(const Suite& s) {
  return s.revolution
             ? DesignShape::revolution(15.0, Aperture::circle(100.0), s.intervals)
             : DesignShape::bspline(15.0, Aperture::rectangle(100.0, 100.0), s.intervals, s.intervals);
}

DesignShape hidden_shape(const Suite& s, std::uint64_t seed) {
  const DesignShape shape = plain(s);
  Eigen::VectorXd parameters = shape.parameters();
  Rng rng(seed, 0);
  for (double& x : parameters) x = s.size_mm * (2.0 * rng.uniform() - 1.0);
  return shape.with(parameters);
}

Evaluation reflected(const DesignShape& shape, const DesignRays& rays, const TentBins& bins,
                     std::uint64_t n) {
  EvaluationOptions o;
  o.rays = n;
  o.derivatives = false;
  o.direct_light = false;
  return evaluate(shape, Reflectance(1.0), rays, bins, o);
}

/// Is the paraboloid's light as far from the hidden mirror's as the suite wants?
bool far_enough(const Suite& s, const DesignShape& truth, const DesignRays& rays) {
  constexpr int kCells = 400;
  constexpr std::uint64_t kRays = std::uint64_t{1} << 18;
  const Evaluation e = reflected(truth, rays, TentBins::square(Frame(), 1.0, kCells), kRays);
  std::vector<DirectedFlux> light;
  for (int k = 0; k < kCells * kCells; ++k) {
    const int column = k % kCells, row = k / kCells;
    const double u = 2.0 * (column + 0.5) / kCells - 1.0, v = 2.0 * (row + 0.5) / kCells - 1.0;
    if (u * u + v * v < 1.0 && e.flux[k] > 0.0) {
      light.push_back({Direction::from_unit({u, v, std::sqrt(1.0 - u * u - v * v)}), e.flux[k]});
    }
  }
  const TentBins bins = s.revolution ? ring_window(light, Direction()) : square_window(light, Direction());
  const double start = bin_error(reflected(plain(s), rays, bins, kRays),
                                 reflected(truth, rays, bins, rays.size()).flux, bins, TargetMode::absolute)
                           .relative_rms;
  return start >= s.low && start <= s.high;
}

/// The suite's first mirrors.
std::vector<DesignShape> hidden_shapes(const Suite& s, int count) {
  std::vector<DesignShape> out;
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  const PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15}), {}};
  for (std::uint64_t seed = 1; static_cast<int>(out.size()) < count && seed < 400; ++seed) {
    DesignRays rays({source}, Frame(), 1000 + seed);
    rays.grow(std::uint64_t{1} << 20);
    const DesignShape truth = hidden_shape(s, seed);
    if (far_enough(s, truth, rays)) out.push_back(truth);
  }
  return out;
}

DesignProblem hidden_problem(const Run& run, const Suite& s, const DesignShape& truth) {
  const std::string scene = fmt::format(
      "[[source]]\nkind = \"cylinder\"\nposition_mm = [0, 0, 15]\n[[reflector]]\nfamily = \"{}\"\n{}focal_mm "
      "= "
      "15.0\n{}position_mm = [0, 0, 0]\naxis = \"+z\"\nreflectance = 1.0\n",
      s.revolution ? "revolution" : "bspline", s.revolution ? "preset = \"parabola\"\n" : "",
      s.revolution ? "diameter_mm = 100.0\n" : "aperture = \"rectangle\"\nsize_mm = [100.0, 100.0]\n");
  // Any light towards +z: what the hidden mirror makes takes its place.
  const bench::SyntheticTarget up{"up", [](const Direction& d) { return std::max(0.0, d.z()); }};
  const fs::path any = written(run, "any", bench::table_of(up, 30.0, 5.0));
  DesignProblem p = problem(run, scene, any, "absolute");
  p.start = plain(s);
  p.knot_doublings = 0;
  p.fixed_knots = run.fixed_knots;
  Scene scene_of_truth = p.project.scene;
  scene_of_truth.reflectors.front().reflector = truth.reflector();
  p.target.distribution =
      traced_table(scene_of_truth, s.revolution ? 360.0 : 0.5, s.revolution ? 0.1 : 0.5, run.target_rays);
  return p;
}

/// "0.19, 0.41, 0.66": smallest, median, largest; per cent.
std::string spread(std::vector<double> errors) {
  std::ranges::sort(errors);
  return fmt::format("{:.2f}, {:.2f}, {:.2f}", 100.0 * errors.front(),
                     100.0 * 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]),
                     100.0 * errors.back());
}

void hidden(const Run& run) {
  Table table("| case | mirrors | min, median, max | exact mirrors | bar | seconds |");
  for (const Suite& s : kSuites) {
    if (!selected(run, s.name)) continue;
    std::vector<double> exact, found;
    for (const DesignShape& truth : hidden_shapes(s, run.targets)) {
      const DesignProblem p = hidden_problem(run, s, truth);
      const std::string name = fmt::format("{} {}", s.name, found.size() + 1);
      const Validated best = validated(run, p, truth);
      print_line(name + " exact", best, "not designed");
      Validated j;
      solve(run, name, p, s.seconds, j);
      exact.push_back(best.error().c48.excess);
      found.push_back(j.error().c48.excess);
    }
    if (found.empty()) continue;
    table.row("| {} | {} | {} | {} | {:.1f} | {:g} |", s.name, found.size(), spread(found), spread(exact),
              100.0 * s.bar, s.seconds);
  }
  table.print();
}

Run parsed(int argc, char** argv) {
  Run run;
  const auto value = [&](int& i) { return std::string(i + 1 < argc ? argv[++i] : "0"); };
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--time") {
      run.time_s = std::stod(value(i));
    } else if (a == "--rays") {
      run.rays = static_cast<std::uint64_t>(std::stod(value(i)));
    } else if (a == "--target-rays") {
      run.target_rays = static_cast<std::uint64_t>(std::stod(value(i)));
    } else if (a == "--seed") {
      run.seed = std::stoull(value(i));
    } else if (a == "--slope") {
      run.slope_deg = std::stod(value(i));
    } else if (a == "--targets") {
      run.targets = std::stoi(value(i));
    } else if (a == "--light-weight") {
      run.light_weight = std::stod(value(i));
    } else if (a == "--family") {
      run.family = value(i);
    } else if (a == "--mirrors") {
      run.mirrors = value(i);
    } else if (a == "--source") {
      run.source = value(i);
    } else if (a == "--device") {
      run.device = design_accelerator(value(i) == "cuda" ? TraceDevice::cuda : TraceDevice::cpu);
    } else if (a == "--start") {
      run.start_only = true;
    } else if (a == "--history") {
      run.history = true;
    } else if (a == "--keep") {
      run.keep = true;
    } else if (a == "--fixed-knots") {
      run.fixed_knots = true;
    } else if (run.mode.empty()) {
      run.mode = a;
    } else {
      run.names.push_back(a);
    }
  }
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  Run run = parsed(argc, argv);
  const std::map<std::string, void (*)(const Run&)> modes{
      {"files", files}, {"synthetic", synthetic}, {"attainable", attainable}, {"hidden", hidden}};
  const auto mode = modes.find(run.mode);
  if (mode == modes.end()) {
    fmt::print("usage: bench_real_targets [options] files|synthetic|attainable|hidden [NAME ...]\n");
    return 2;
  }
  run.folder = fs::temp_directory_path() /
               fmt::format("lucerna-bench-{}", std::chrono::steady_clock::now().time_since_epoch().count());
  fs::create_directories(run.folder);
  mode->second(run);
  if (run.keep) {
    fmt::print("kept: {}\n", run.folder.string());
  } else {
    fs::remove_all(run.folder);
  }
}
