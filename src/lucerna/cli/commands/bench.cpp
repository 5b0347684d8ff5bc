// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/trace/benchmark/benchmark.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna::cli {

namespace {

struct BenchArguments {
  std::string device = "auto", rays = "1e6", cells = "256,1024,2048";
};

std::vector<int> parse_cells(const std::string& word) {
  std::vector<int> all;
  for (const double n : parse_numbers(word)) {
    const int cells = static_cast<int>(std::clamp(n, 0.0, 1e6));
    if (cells < 8 || cells > 8192 || (cells & (cells - 1)) != 0 || static_cast<double>(cells) != n)
      throw UsageError(fmt::format("--cells {}: expected powers of two from 8 to 8192", word));
    all.push_back(cells);
  }
  return all;
}

Json metrics_json(const BenchmarkMetrics& f) {
  Json json{{"scene", f.scene},
            {"cells", f.cells},
            {"rays", f.rays},
            {"rays_per_s", f.rays_per_s},
            {"rays_per_cpu_s", f.rays_per_cpu_s},
            {"casts_per_ray", f.casts_per_ray},
            {"build_ms", f.build_ms},
            {"update_ms", f.update_ms},
            {"heights_mb", f.heights_mb},
            {"hierarchy_mb", f.hierarchy_mb}};
  json["embree"] = Json();
  if (f.embree_rays_per_cpu_s) {
    json["embree"] = {{"rays_per_cpu_s", *f.embree_rays_per_cpu_s},
                      {"build_ms", *f.embree_build_ms},
                      {"ratio", f.rays_per_cpu_s / *f.embree_rays_per_cpu_s}};
  }
  return json;
}

void run_bench(const BenchArguments& a, Session& session) {
  session.start();
  if (trace_device(a.device) == TraceDevice::cuda) {
    const std::string why = cuda_unavailable_reason();
    throw InputError("--device cuda: " + (why.empty() ? "bench_gpu measures the card" : why));
  }
  const std::vector<int> sizes = parse_cells(a.cells);
  const std::uint64_t count = parse_count(a.rays);
  if (count == 0 || count > 100'000'000)
    throw UsageError(fmt::format("--rays {}: expected 1 to 1e8", a.rays));
  const auto rays = benchmark_rays(count);
  Json results = Json::array();
  std::string isa;
  session.print_line(fmt::format("{} rays in random order, {} threads; one = processor time of one thread",
                                 count, ThreadLimit::current()));
  session.print_line(
      "scene cells  M rays/s  M rays/s one  casts/ray  build ms  update ms  heights MB  tree MB  Embree one  "
      "ratio");
  for (const int cells : sizes) {
    for (const BenchmarkScene& scene : benchmark_scenes()) {
      const BenchmarkMetrics f =
          session.timed("bench", [&] { return run_benchmark(scene, cells, rays, session.progress()); });
      isa = f.isa;
      std::string embree = "         -      -";
      if (f.embree_rays_per_cpu_s) {
        embree = fmt::format("{:10.2f} {:6.1f}", 1e-6 * *f.embree_rays_per_cpu_s,
                             f.rays_per_cpu_s / *f.embree_rays_per_cpu_s);
      }
      session.print_line(
          fmt::format("{:5} {:5}  {:8.2f}  {:12.2f}  {:9.3f}  {:8.1f}  {:9.2f}  {:10.2f}  {:7.2f}  {}",
                      f.scene, f.cells, 1e-6 * f.rays_per_s, 1e-6 * f.rays_per_cpu_s, f.casts_per_ray,
                      f.build_ms, f.update_ms, f.heights_mb, f.hierarchy_mb, embree));
      results.push_back(metrics_json(f));
    }
  }
  session.print_line(fmt::format("instruction set: {}", isa));
  Json json = session.json_head(std::nullopt, isa);
  json["device"] = "cpu";
  json["results"] = results;
  session.print_json(json);
}

}  // namespace

void add_bench(CLI::App& app, Session& session, int&) {
  Command command(app, "bench", "Measure how fast light is traced on this machine");
  auto arguments = std::make_shared<BenchArguments>();
  command.option("--device", arguments->device,
                 "cpu or auto, which are the same: bench_gpu measures a graphics card");
  command.option("--rays", arguments->rays, "Rays a measurement, 1 to 1e8");
  command.option("--cells", arguments->cells, "Cells a side of the mirror, powers of two from 8 to 8192");
  session.add_json(command);
  session.add_common(command);
  command.on_run([arguments, &session] { run_bench(*arguments, session); });
}

}  // namespace lucerna::cli
