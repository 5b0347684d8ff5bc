// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/lens_files.h"

#include <nlohmann/json.hpp>

#include "lucerna/cad.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/results/folders/trace_files.h"

namespace lucerna {

void write_lens_progress(const std::filesystem::path& folder, const LensProblem& problem,
                         const ShapedLens& best, std::string_view history) {
  write_file(folder / "history.csv", history);
  Project project = with_lens(problem, best);
  toml_tables(project).erase("target");
  toml_tables(project).erase("design");
  write_file(folder / "lens.toml", project_text(project));
}

std::vector<std::string> write_lens_files(const std::filesystem::path& folder, const LensProblem& problem,
                                          const LensResult& result, const DesignMetrics& figures,
                                          const TraceResult& traced, std::string_view history,
                                          const nlohmann::ordered_json& json) {
  write_lens_progress(folder, problem, result.lens, history);
  const Solid solid = shaped_solid(problem, result.lens);
  // Fine enough for another program's trace: sides of half a degree of a curve's turn.
  constexpr double kMeshTolerance = 5e-6;
  const auto mesh = surface_mesh(solid, kMeshTolerance);
  write_file(folder / "lens.stl", stl_bytes(*mesh));
  write_file(folder / "lens.obj", obj_text(*mesh));
  write_file(folder / "lens.step",
             solid.face ? solid_step_text(solid.outline_mm, BodyFaces{*solid.face, solid.bottom_face.get()},
                                          solid.smooth_below_deg)
                        : solid_step_text(solid.outline_mm, solid.smooth_below_deg));
  std::vector<std::string> names{"lens.toml", "lens.step", "lens.stl", "lens.obj", "history.csv"};
  if (solid.face) {
    // Those of another lens, where the folder had one.
    for (const char* name : {"lens.dxf", "lens.csv"}) std::filesystem::remove(folder / name);
  } else {
    const auto profile = solid_profile(solid.outline_mm, solid.smooth_below_deg);
    write_file(folder / "lens.dxf", dxf_profile(profile));
    write_file(folder / "lens.csv", csv_profile(profile));
    names.insert(names.end(), {"lens.dxf", "lens.csv"});
  }
  const Project project = with_lens(problem, result.lens);
  for (std::string& name :
       write_trace_files(folder, trace_origin(project), figures.trace, traced.out_rays, json))
    names.push_back(std::move(name));
  return names;
}

}  // namespace lucerna
