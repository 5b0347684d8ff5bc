// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/scene.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The tables of a project file as they were read; a value that is copied deeply. `project_text` writes them.
class ProjectTables {
 public:
  /// No tables.
  ProjectTables();
  ~ProjectTables();
  /// A deep copy.
  ProjectTables(const ProjectTables& other);
  /// Takes the tables of `other`, which may then only be destroyed or assigned to.
  ProjectTables(ProjectTables&& other) noexcept;
  /// A deep copy.
  ProjectTables& operator=(const ProjectTables& other);
  /// Takes the tables of `other`.
  ProjectTables& operator=(ProjectTables&& other) noexcept;

  /// For the library itself.
  struct Toml;
  /// For the library itself.
  Toml& toml() { return *toml_; }
  /// For the library itself.
  const Toml& toml() const { return *toml_; }

 private:
  std::unique_ptr<Toml> toml_;
};

/// A project file, read: what is to be traced.
struct Project {
  /// Sources, mirrors, bodies and detectors.
  Scene scene;
  /// Every file that the result depends on: the project and what it names.
  std::vector<std::filesystem::path> inputs;
  /// What was odd in the files but could be read, each with its place.
  std::vector<std::string> warnings;
  /// The file's tables with all file names made absolute, so that it can be written elsewhere and run again.
  ProjectTables tables;
};

/// Reads a project: [[source]], [[reflector]], [[body]], [[detector]]; [target] and [design] are left to
/// `design`. Ray files are read whole. Throws InputError with file, line, key, found and expected: unknown
/// keys name the nearest known one. Thread safe.
[[nodiscard]] Project read_project(const std::filesystem::path& path, Progress& progress = no_progress());

/// The text of the project's tables.
[[nodiscard]] std::string project_text(const Project& project);

/// A commented project file with every kind of table: what `lucerna init` writes. It reads as it is; what it
/// has beside one source, one reflector and one detector is commented out with '#' straight before the key
/// (prose has a blank after it), in blocks that each read once they are uncommented.
[[nodiscard]] std::string project_template();

}  // namespace lucerna
#pragma GCC visibility pop
