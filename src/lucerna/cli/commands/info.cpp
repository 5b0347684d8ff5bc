// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <exception>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/describe.h"
#include "lucerna/cli/parse/input_kind.h"
#include "lucerna/cli/parse/photometric_arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

struct InfoArguments {
  std::vector<std::string> files;
  std::string format;
  PhotometricArguments photometric;
};

Description describe(const std::string& path, const InfoArguments& a, Session& session) {
  if (is_source_model(path)) return describe_model(path);
  if (is_glass_catalogue(path)) return describe_catalogue(path);
  if (is_bsdf_file(path)) return describe_bsdf(path);
  if (a.format.empty() && is_photometric_file(path)) {
    return describe_photometry(path, a.photometric.read_options(session.strict));
  }
  if (a.format.empty()) require_ray_file(path);
  return describe_rays(path, a.format, session);
}

Json say(const std::string& path, const InfoArguments& a, Session& session) {
  const Description d = session.timed("read", [&] { return describe(path, a, session); });
  if (session.strict && !d.warnings.empty())
    throw InputError(fmt::format("{}: {}", path, d.warnings.front()));
  session.add_input(path);
  session.print_line(path);
  for (const std::string& line : d.lines) session.print_line(line);
  for (const std::string& warning : d.warnings) session.print_line("  warning: " + warning);
  return d.json;
}

/// A file that cannot be read does not hide the others: they are told of first, then its error.
void info(const InfoArguments& a, Session& session) {
  session.start();
  Json list = Json::array();
  std::exception_ptr first_error;
  for (const std::string& path : a.files) {
    try {
      list.push_back(say(path, a, session));
    } catch (const InputError& e) {
      if (first_error) {
        session.note(e.what());
      } else {
        first_error = std::current_exception();
      }
    }
  }
  if (session.json && !list.empty()) {
    Json result = session.json_head(std::nullopt);
    result["files"] = std::move(list);
    session.print_json(result);
  }
  if (first_error) std::rethrow_exception(first_error);
}

}  // namespace

void add_info(CLI::App& app, Session& session, int&) {
  Command command(
      app, "info",
      "Say what is in a ray file, model, IES or EULUMDAT file, catalogue of glasses or measured BRDF");
  auto arguments = std::make_shared<InfoArguments>();
  command.required("FILE", arguments->files, "Files");
  command.option("--format", arguments->format, "Read ray files as this format, whatever their content says");
  arguments->photometric.add_read(command);
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run([arguments, &session] { info(*arguments, session); });
}

}  // namespace lucerna::cli
