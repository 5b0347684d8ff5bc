// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/design_files.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "lucerna/cad.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/search/checkpoint.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/design/validation/mesh_tolerance.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/results/folders/trace_files.h"

namespace lucerna {

namespace {

/// A checkpoint takes a few dozen bytes a parameter, a history a hundred a step.
constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;

/// The designed project without [target] and [design]: what the mirror does with the light, to be traced.
std::string traceable(const DesignProblem& problem, const DesignShape& shape) {
  Project project = with_shape(problem, shape);
  toml_tables(project).erase("target");
  toml_tables(project).erase("design");
  return project_text(project);
}

/// The lines of a history that were written before evaluation `max`, and the header.
std::string history_until(const std::string& history, int max) {
  std::string out;
  for (std::size_t at = 0; at < history.size();) {
    const std::size_t end = std::min(history.find('\n', at), history.size() - 1) + 1;
    const std::string line = history.substr(at, end - at);
    int evaluations = 0;
    std::from_chars(line.data(), line.data() + line.size(), evaluations);
    if (at == 0 || evaluations <= max) out += line;
    at = end;
  }
  return out;
}

}  // namespace

void write_design_progress(const std::filesystem::path& folder, const DesignProblem& problem,
                           const DesignShape& best, std::string_view history, std::string_view checkpoint) {
  write_file(folder / "history.csv", history);
  write_file(folder / "reflector.toml", traceable(problem, best));
  write_file(folder / "checkpoint", checkpoint);
}

DesignProgress read_design_progress(const std::filesystem::path& folder) {
  DesignProgress start;
  if (!std::filesystem::exists(folder / "checkpoint")) return start;
  start.checkpoint = read_file(folder / "checkpoint", kMaxBytes);
  if (std::filesystem::exists(folder / "history.csv")) {
    start.history =
        history_until(read_file(folder / "history.csv", kMaxBytes), checkpoint_evaluations(start.checkpoint));
  }
  return start;
}

std::vector<std::string> write_reflector_files(const std::filesystem::path& folder,
                                               const Reflector& reflector, CadTolerance stl) {
  CadTolerance tolerance;
  const auto profile = cad_profile(reflector, tolerance);
  write_file(folder / "reflector.step", step_text(reflector));
  write_file(folder / "reflector.stl", stl_bytes(cad_mesh_within(reflector, stl)));
  write_file(folder / "reflector.obj", obj_text(cad_mesh_within(reflector, tolerance)));
  write_file(folder / "reflector.dxf", dxf_profile(profile));
  write_file(folder / "reflector.csv", csv_profile(profile));
  return {"reflector.step", "reflector.stl", "reflector.obj", "reflector.dxf", "reflector.csv"};
}

std::vector<std::string> write_design_files(const std::filesystem::path& folder, const DesignProblem& problem,
                                            const DesignResult& result, const DesignMetrics& figures,
                                            const TraceResult& traced, std::string_view history,
                                            const nlohmann::ordered_json& json) {
  write_design_progress(folder, problem, result.shape, history, result.checkpoint);
  std::vector<std::string> names{"reflector.toml"};
  // As fine as that of a validation by many rays.
  const ErrorBoxes boxes(target_rectangle(problem.target));
  const CadTolerance stl =
      mesh_tolerance(boxes, box_target(boxes, problem.target, 1.0), problem.world_from_mirror.origin_mm());
  for (std::string& name : write_reflector_files(folder, result.shape.reflector(), stl))
    names.push_back(std::move(name));
  names.insert(names.end(), {"history.csv", "checkpoint"});
  if (figures.tolerances) {
    write_file(folder / "tolerances.csv", tolerances_csv(*figures.tolerances));
    names.emplace_back("tolerances.csv");
  } else {
    std::filesystem::remove(folder / "tolerances.csv");  // that of another mirror
  }
  const Project project = with_shape(problem, result.shape);
  for (std::string& name :
       write_trace_files(folder, trace_origin(project), figures.trace, traced.out_rays, json)) {
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace lucerna
