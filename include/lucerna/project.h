// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/intensity.h"
#include "lucerna/progress.h"
#include "lucerna/scene.h"
#include "lucerna/source_model.h"

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

/// What the `file` keys of a project may name that is in memory and in no file. The names are as the project
/// has them, relative to its folder or absolute; no file of such a name is read. None is null.
struct ProjectMemory {
  /// For [[source]].
  std::map<std::string, std::shared_ptr<const SourceModel>> models;
  /// For [[source]].
  std::map<std::string, std::shared_ptr<const RaySet>> rays;
  /// For [target].
  std::map<std::string, std::shared_ptr<const IntensityDistribution>> targets;

  /// True if nothing is in memory.
  bool empty() const { return models.empty() && rays.empty() && targets.empty(); }
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
  /// What of it is in no file; by absolute names.
  ProjectMemory memory;
};

/// Reads a project: [[source]], [[reflector]], [[body]], [[detector]]; [target] and [design] are left to
/// `design`. Ray files are read whole. Throws InputError with file, line, key, found and expected: unknown
/// keys name the nearest known one. Thread safe.
[[nodiscard]] Project read_project(const std::filesystem::path& path, Progress& progress = no_progress());

/// The same from text, as if it had been read from `path`: a name for messages, which need not be there, and
/// whose folder other file names are relative to. `memory` is what of its files is in memory.
[[nodiscard]] Project parse_project(std::string_view text, const std::filesystem::path& path,
                                    const ProjectMemory& memory = {}, Progress& progress = no_progress());

/// The mirrors of a text that has [[reflector]] tables and nothing else, in their order; a mesh, which is a
/// body, is refused. Errors and `path` as `parse_project`.
[[nodiscard]] std::vector<PlacedReflector> parse_reflectors(std::string_view text,
                                                            const std::filesystem::path& path);

/// The text of the project's tables.
[[nodiscard]] std::string project_text(const Project& project);

/// A copy of the project that is all in files: writes what is in memory to `folder`, which is there, as .nfl,
/// .tm25ray and .ldt (a radiometric target as .ies), and names these files. What is there stays: another file
/// of a name is passed over ("model-1-2.nfl"). Throws InputError where a file cannot be written.
[[nodiscard]] Project save_memory(const Project& project, const std::filesystem::path& folder);

/// A commented project file with every kind of table: what `lucerna init` writes. It reads as it is; what it
/// has beside one source, one reflector and one detector is commented out with '#' straight before the key
/// (prose has a blank after it), in blocks that each read once they are uncommented.
[[nodiscard]] std::string project_template();

}  // namespace lucerna
#pragma GCC visibility pop
