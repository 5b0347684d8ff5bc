// SPDX-License-Identifier: Apache-2.0
// Any bytes as a project file, with what [target] and [design] ask for: a scene, or InputError.
#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/project.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size, ".toml");
  try {
    lucerna::Project project = lucerna::read_project(file.path());
    require(!project_text(project).empty());
    lucerna::design_problem(std::move(project), file.path());
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
  return 0;
}
