// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/photometric_arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/rayset/files/ray_check.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

/// One thing that `check` found; severity "note", "warning" or "error".
struct FileFault {
  std::string severity, text;
};

std::vector<FileFault> check_photometry(const std::string& path, const PhotometricReadOptions& options) {
  std::vector<FileFault> faults;
  for (const Fault& fault : check_photometric_file(path, options)) {
    const char* severity = fault.severity == Fault::Severity::note      ? "note"
                           : fault.severity == Fault::Severity::warning ? "warning"
                                                                        : "error";
    faults.push_back(
        {severity, fault.line > 0 ? fmt::format("line {}: {}", fault.line, fault.text) : fault.text});
  }
  return faults;
}

std::vector<FileFault> check_rays(const std::string& path, Session& session) {
  std::vector<FileFault> faults;
  for (const Finding& finding : check_ray_file(path, {}, session.progress())) {
    const bool error = finding.severity == Severity::error || session.strict;
    faults.push_back(
        {error ? "error" : "warning",
         finding.place.empty() ? finding.message : fmt::format("{}: {}", finding.place, finding.message)});
  }
  return faults;
}

std::vector<FileFault> check_file(const std::string& path, const PhotometricArguments& photometric,
                                  Session& session) {
  try {
    if (is_source_model(path)) {
      static_cast<void>(load_source_model(path));  // throws where the file is damaged
      return {};
    }
    if (is_photometric_file(path)) return check_photometry(path, photometric.read_options(session.strict));
    return check_rays(path, session);
  } catch (const InputError& e) {
    return {{"error", e.what()}};
  }
}

/// Files as given; a folder represents every regular file below it, by name.
std::vector<std::string> expand(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
      if (entry.is_regular_file()) inside.push_back(entry.path().string());
    }
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

std::size_t count(const std::vector<FileFault>& faults, const std::string& severity) {
  return static_cast<std::size_t>(std::count_if(faults.begin(), faults.end(),
                                                [&](const FileFault& f) { return f.severity == severity; }));
}

void check(const std::vector<std::string>& paths, const PhotometricArguments& photometric, Session& session,
           int& exit_code) {
  session.start();
  const std::vector<std::string> files = expand(paths);
  std::size_t clean = 0, warned = 0, failed = 0;
  Json list = Json::array();
  for (const std::string& path : files) {
    const auto faults = session.timed("check", [&] { return check_file(path, photometric, session); });
    const std::size_t errors = count(faults, "error"), warnings = count(faults, "warning");
    ++(errors > 0 ? failed : warnings > 0 ? warned : clean);
    Json entries = Json::array();
    for (const FileFault& f : faults) entries.push_back({{"severity", f.severity}, {"text", f.text}});
    list.push_back({{"path", path}, {"errors", errors}, {"warnings", warnings}, {"faults", entries}});
    session.print_line(fmt::format("{}: {}", path, errors > 0 ? "error" : warnings > 0 ? "warning" : "ok"));
    for (const FileFault& f : faults) session.print_line(fmt::format("  {}: {}", f.severity, f.text));
  }
  session.print_line(
      fmt::format("{} files: {} ok, {} with warnings, {} with errors", files.size(), clean, warned, failed));
  if (session.json) {
    Json result = session.json_head(std::nullopt);
    result["files"] = std::move(list);
    result["ok"] = clean;
    result["with_warnings"] = warned;
    result["with_errors"] = failed;
    session.print_json(result);
  }
  if (failed > 0) exit_code = 1;
}

}  // namespace

void add_check(CLI::App& app, Session& session, int& exit_code) {
  Command command(app, "check", "Name every fault of files or folders with its place");
  auto paths = std::make_shared<std::vector<std::string>>();
  auto photometric = std::make_shared<PhotometricArguments>();
  command.required("FILE", *paths, "Files or folders");
  photometric->add_read(command);
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run(
      [paths, photometric, &session, &exit_code] { check(*paths, *photometric, session, exit_code); });
}

}  // namespace lucerna::cli
