// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/project/schema/project_files.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/schema/short_numbers.h"
#include "lucerna/project/schema/toml_reader.h"
#include "lucerna/project/schema/toml_text.h"
#include "lucerna/project/sections/project_memory.h"
#include "lucerna/project/sections/project_parts.h"
#include "lucerna/trace/engines/ray_colours.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// Makes every name of a file absolute, so that the project can be written to another folder.
void make_files_absolute(toml::table& table, const fs::path& folder) {
  for_each_file(table,
                [&](std::string& name) { name = fs::absolute(folder / name).lexically_normal().string(); });
}

/// A source that is partly before and partly behind a mirror reaches through it: nearly always a hole that
/// was forgotten, or rays that a file has on a surface larger than the mirror allows.
void check_sources_before_mirrors(Project& project, const std::string& file) {
  constexpr double kFew = 1e-3;
  const Scene& scene = project.scene;
  for (std::size_t s = 0; s < scene.sources.size(); ++s) {
    for (std::size_t m = 0; m < scene.reflectors.size(); ++m) {
      const double share = share_behind(scene.sources[s], scene.reflectors[m]);
      const std::string who =
          fmt::format("source[{}]: {:.3g} % of its rays start behind reflector[{}]", s, 100.0 * share, m);
      if (share >= kFew && share <= 1.0 - kFew) {
        throw InputError(fmt::format("{}: {}: the source reaches through the mirror; expected a "
                                     "hole_diameter_mm that lets it pass, or another position_mm",
                                     file, who),
                         ErrorCause::contradiction);
      }
      if (share > 0.0) project.warnings.push_back(fmt::format("{}: {}", file, who));
    }
  }
}

/// Says how much light has a wavelength that a dispersing solid does not know, by the first rays.
void warn_of_wavelengths(Project& project, const std::string& file) {
  constexpr std::size_t kRays = 4096;
  const RayColours colours(project.scene);
  if (!colours.are_needed()) return;
  const Sequence sequence(SequenceKind::random, 1);
  std::vector<float> nm(kRays);
  RayBlock rays;
  rays.resize(kRays);
  for (std::size_t s = 0; s < project.scene.sources.size(); ++s) {
    project.scene.sources[s].rays->emit(sequence, 0, rays);
    colours.emit(s, sequence, 0, nm);
    const auto warn = [&](const auto& is_unknown, const std::string& what) {
      double some = 0.0, all = 0.0;
      for (std::size_t i = 0; i < kRays; ++i) {
        const double weight = rays.weight[i], at = nm[i];
        all += weight;
        some += is_unknown(at) ? weight : 0.0;
      }
      if (!(some > 0.0)) return;
      project.warnings.push_back(fmt::format("{}: source[{}]: some {:.3g} % of its light has {}", file, s,
                                             100.0 * some / all, what));
    };
    warn([](double w) { return !(w > 0.0); },
         "no wavelength: it meets the index at the `wavelength_nm` of the solid");
    for (const Solid& solid : project.scene.solids) {
      if (solid.dispersion == nullptr) continue;
      const double min_nm = solid.dispersion->min_nm(), max_nm = solid.dispersion->max_nm();
      warn([&](double w) { return w > 0.0 && !(w >= min_nm && w <= max_nm); },
           fmt::format("wavelengths out of {:g} to {:g} nm: in '{}' it meets the index of the nearer end",
                       min_nm, max_nm, solid.name));
    }
  }
}

}  // namespace

namespace project_parts {

Frame read_placement(TomlReader& reader) {
  const Vec3 position = reader.vector("position_mm").value_or(Vec3{});
  const Direction axis = reader.axis("axis").value_or(Direction());
  return Frame::from_axis(axis, radians(reader.number("turn_deg", 0.0)), position);
}

}  // namespace project_parts

namespace {

/// Reads the tables that `project` has, as those of the file `path`.
void read_tables(Project& project, const fs::path& path, Progress& progress) {
  TomlReader root(toml_tables(project), path.string(), "");
  const auto sources = root.tables("source");
  const auto reflectors = root.tables("reflector");
  const auto bodies = root.tables("body");
  const auto detectors = root.tables("detector");
  // What belongs to `design` alone is read there; here it is only known.
  root.has("target");
  root.has("design");
  root.finish();
  if (sources.empty()) root.missing("source", "a project needs at least one [[source]]");
  for (const TomlReader& reader : reflectors) project_parts::read_reflector(reader, project);
  for (const TomlReader& reader : bodies) project_parts::read_body(reader, project);
  std::set<std::string> names;
  for (const TomlReader& reader : detectors) {
    const std::string name = project_parts::read_detector(reader, project.scene);
    if (!names.insert(name).second) reader.fail("name", fmt::format("two detectors are named '{}'", name));
  }
  if (detectors.empty()) project.scene.far_fields.emplace_back();
  // Sources last: a wrong key anywhere is told before gigabytes are read.
  for (const TomlReader& reader : sources)
    project.scene.sources.push_back(project_parts::read_source(reader, project, progress));
  try {
    check(project.scene);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()), e.cause());
  }
  check_sources_before_mirrors(project, path.string());
  warn_of_wavelengths(project, path.string());
  make_files_absolute(toml_tables(project), fs::absolute(path).parent_path());
}

}  // namespace

Project read_project(const fs::path& path, Progress& progress) {
  Project project;
  toml_tables(project) = parse_toml_file(path);
  project.inputs.push_back(path);
  read_tables(project, path, progress);
  return project;
}

Project parse_project(std::string_view text, const fs::path& path, const ProjectMemory& memory,
                      Progress& progress) {
  Project project;
  toml_tables(project) = parse_toml_text(text, path.string());
  project.memory = absolute_names(memory, path);
  read_tables(project, path, progress);
  return project;
}

std::vector<PlacedReflector> parse_reflectors(std::string_view text, const fs::path& path) {
  Project project;
  toml_tables(project) = parse_toml_text(text, path.string());
  TomlReader root(toml_tables(project), path.string(), "");
  const auto reflectors = root.tables("reflector");
  root.finish();
  for (const TomlReader& reader : reflectors) {
    project_parts::read_reflector(reader, project);
    if (!project.scene.bodies.empty()) {
      reader.fail("family", "found a mesh, which is a body; expected a surface");
    }
  }
  return std::move(project.scene.reflectors);
}

std::string project_text(const Project& project) {
  std::ostringstream out;
  out << toml_tables(project) << '\n';
  return short_numbers(out.str());
}

}  // namespace lucerna
