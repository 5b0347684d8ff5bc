// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/sections/project_memory.h"

#include <fmt/format.h>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/project/schema/project_files.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/ray_file.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

template <class Object>
std::map<std::string, Object> absolute_keys(const std::map<std::string, Object>& objects,
                                            const fs::path& folder) {
  std::map<std::string, Object> out;
  for (const auto& [name, object] : objects) out[(folder / name).lexically_normal().string()] = object;
  return out;
}

/// A name of its own in `folder`: that of the object with another ending.
fs::path place_of(const std::string& name, const fs::path& folder, const char* ending) {
  return (fs::absolute(folder) / fs::path(name).filename()).replace_extension(ending).lexically_normal();
}

/// Writes to the first of "name", "name-2", "name-3", ... that is free, unless one before it holds the same
/// bytes. Returns the name of what holds them.
template <class Write>
fs::path write_beside(const fs::path& file, const Write& write) {
  const auto place = [&](int n) {
    return n == 1 ? file
                  : file.parent_path() /
                        fmt::format("{}-{}{}", file.stem().string(), n, file.extension().string());
  };
  int free = 1;
  while (fs::exists(place(free))) ++free;
  write(place(free));
  const std::string written = free > 1 ? sha256_of_file(place(free)) : "";
  for (int n = 1; n < free; ++n) {
    if (sha256_of_file(place(n)) != written) continue;
    fs::remove(place(free));
    return place(n);
  }
  return place(free);
}

}  // namespace

ProjectMemory absolute_names(const ProjectMemory& memory, const fs::path& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  return {absolute_keys(memory.models, folder), absolute_keys(memory.rays, folder),
          absolute_keys(memory.targets, folder)};
}

Project save_memory(const Project& project, const fs::path& folder) {
  Project saved = project;
  saved.memory = {};
  std::map<std::string, std::string> new_names;
  const auto add = [&](const std::string& name, const fs::path& file) {
    new_names[name] = file.string();
    saved.inputs.push_back(file);
  };
  for (const auto& [name, model] : project.memory.models) {
    add(name, write_beside(place_of(name, folder, ".nfl"),
                           [&source = *model](const fs::path& file) { save_source_model(file, source); }));
  }
  for (const auto& [name, rays] : project.memory.rays) {
    add(name, write_beside(place_of(name, folder, ".tm25ray"),
                           [&set = *rays](const fs::path& file) { write_ray_set(file, set, "tm25"); }));
  }
  for (const auto& [name, target] : project.memory.targets) {
    const bool lumen = target->unit == FluxUnit::lumen;
    const auto write = [&light = *target, lumen](const fs::path& file) {
      write_photometric_file(file, {light, {}}, lumen ? PhotometricFormat::ldt : PhotometricFormat::ies_2019,
                             {.digits = 17});
    };
    add(name, write_beside(place_of(name, folder, lumen ? ".ldt" : ".ies"), write));
  }
  for_each_file(toml_tables(saved), [&](std::string& name) {
    const auto found = new_names.find(name);
    if (found != new_names.end()) name = found->second;
  });
  return saved;
}

}  // namespace lucerna
