// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/bsdf.h"
#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/describe.h"
#include "lucerna/cli/parse/input_kind.h"
#include "lucerna/cli/parse/photometric_arguments.h"
#include "lucerna/cli/parse/traceable_project.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/files/ray_check.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

std::vector<Diagnostic> check_rays(const std::string& path, Session& session) {
  std::vector<Diagnostic> found = check_ray_file(path, {}, session.progress());
  for (Diagnostic& d : found) {
    if (session.strict) d.severity = Severity::error;
  }
  return found;
}

std::vector<Diagnostic> as_faults(const std::vector<std::string>& warnings, const Session& session) {
  std::vector<Diagnostic> found;
  for (const std::string& text : warnings)
    found.push_back({session.strict ? Severity::error : Severity::warning, "", text});
  return found;
}

/// A project with all that it names; also the target and the settings of a design, where it has them.
std::vector<std::string> project_warnings(const std::string& path, Session& session) {
  Project project = read_traceable_project(path, session.progress());
  std::vector<std::string> warnings = project.warnings;
  if (is_lens_design(project)) {
    static_cast<void>(lens_problem(std::move(project), path));
  } else if (is_finished_lens(project)) {
    static_cast<void>(finished_lens_target(project, path));
  } else if (toml_tables(project).contains("target") || toml_tables(project).contains("design")) {
    static_cast<void>(design_problem(std::move(project), path));
  }
  return warnings;
}

std::vector<Diagnostic> check_file(const std::string& path, const PhotometricArguments& photometric,
                                   Session& session) {
  try {
    if (is_glass_catalogue(path)) return as_faults(describe_catalogue(path).warnings, session);
    if (is_bsdf_file(path)) {
      static_cast<void>(read_bsdf(path));  // throws where it is faulty, as the others
      return {};
    }
    if (is_project_file(path)) return as_faults(project_warnings(path, session), session);
    if (is_source_model(path)) {
      static_cast<void>(load_source_model(path));  // throws where the file is damaged
      return {};
    }
    if (is_photometric_file(path))
      return check_photometric_file(path, photometric.read_options(session.strict));
    require_ray_file(path);
    return check_rays(path, session);
  } catch (const InputError& e) {
    return {{Severity::error, "", e.what()}};
  }
}

/// Whether a file below a folder is one to be checked, by its content, or by its ending where that is
/// damaged.
bool is_known_kind(const std::filesystem::path& path) {
  constexpr std::array kEndings{".nfl", ".ies", ".ldt", ".agf", ".bsdf"};
  const std::string ending = lower_ending(path);
  if (std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end()) return true;
  const auto formats = ray_formats();
  const auto own = [&](std::string_view format) {
    return ending != ".txt" && ray_file_ending(format) == ending;  // any text may be called .txt
  };
  if (std::any_of(formats.begin(), formats.end(), own)) return true;
  return is_source_model(path) || is_photometric_file(path) || detect_ray_format(path).has_value();
}

/// Files as given; a folder represents those below it that are of a known kind, by name.
struct FileList {
  std::vector<std::string> files;
  /// Of folders: files of other kinds.
  std::size_t others = 0;
};

FileList expand(const std::vector<std::string>& paths) {
  FileList list;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      list.files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
      if (!entry.is_regular_file()) continue;
      if (is_known_kind(entry.path())) {
        inside.push_back(entry.path().string());
      } else {
        ++list.others;
      }
    }
    std::sort(inside.begin(), inside.end());
    list.files.insert(list.files.end(), inside.begin(), inside.end());
  }
  return list;
}

std::size_t count(const std::vector<Diagnostic>& found, Severity severity) {
  return static_cast<std::size_t>(
      std::count_if(found.begin(), found.end(), [&](const Diagnostic& d) { return d.severity == severity; }));
}

void check(const std::vector<std::string>& paths, const PhotometricArguments& photometric, Session& session,
           int& exit_code) {
  session.start();
  const FileList expanded = expand(paths);
  const std::vector<std::string>& files = expanded.files;
  std::size_t clean = 0, warned = 0, failed = 0;
  Json list = Json::array();
  for (const std::string& path : files) {
    const auto found = session.timed("check", [&] { return check_file(path, photometric, session); });
    const std::size_t errors = count(found, Severity::error), warnings = count(found, Severity::warning);
    ++(errors > 0 ? failed : warnings > 0 ? warned : clean);
    Json entries = Json::array();
    for (const Diagnostic& d : found) {
      entries.push_back({{"severity", to_string(d.severity)}, {"text", to_string(d)}});
    }
    list.push_back({{"path", path}, {"errors", errors}, {"warnings", warnings}, {"faults", entries}});
    session.print_line(fmt::format("{}: {}", path, errors > 0 ? "error" : warnings > 0 ? "warning" : "ok"));
    for (const Diagnostic& d : found) {
      session.print_line(fmt::format("  {}: {}", to_string(d.severity), to_string(d)));
    }
  }
  session.print_line(
      fmt::format("{} files: {} ok, {} with warnings, {} with errors", files.size(), clean, warned, failed));
  if (expanded.others > 0) {
    session.print_line(fmt::format(
        "{} other files are no ray files, source models, light distributions, catalogues of glasses or BRDFs",
        expanded.others));
  }
  if (session.json) {
    Json result = session.json_head(std::nullopt);
    result["files"] = std::move(list);
    result["ok"] = clean;
    result["with_warnings"] = warned;
    result["with_errors"] = failed;
    result["other_files"] = expanded.others;
    session.print_json(result);
  }
  if (failed > 0) exit_code = 1;
}

}  // namespace

void add_check(CLI::App& app, Session& session, int& exit_code) {
  Command command(app, "check", "Name every fault of files or folders with its place");
  auto paths = std::make_shared<std::vector<std::string>>();
  auto photometric = std::make_shared<PhotometricArguments>();
  command.required("FILE", *paths,
                   "Ray files, models, IES, EULUMDAT, .agf, .bsdf, projects; or folders of all but projects");
  photometric->add_read(command);
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run(
      [paths, photometric, &session, &exit_code] { check(*paths, *photometric, session, exit_code); });
}

}  // namespace lucerna::cli
