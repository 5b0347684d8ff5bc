// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/traceable_project.h"

#include <fmt/format.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/engines/solids_apart.h"

namespace lucerna::cli {

Project read_traceable_project(const std::filesystem::path& path, Progress& progress) {
  Project project = read_project(path, progress);
  try {
    check_apart(project.scene);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
  for (const std::string& line : within_plates(project.scene))
    project.warnings.push_back(fmt::format("{}: {}", path.string(), line));
  return project;
}

}  // namespace lucerna::cli
