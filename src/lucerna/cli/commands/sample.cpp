// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

struct SampleArguments {
  std::string model, output, count, to, seed = "1", sequence = "random";
};

void run_sample(const SampleArguments& a, Session& session) {
  session.start();
  const std::uint64_t n = parse_count(a.count);
  const std::string format = ray_format_for(a.output, a.to);
  std::error_code missing;
  if (std::filesystem::equivalent(a.model, a.output, missing))
    throw UsageError(fmt::format("{}: found the model itself, expected another file for its rays", a.output));
  SampleOptions options{.sequence = sequence_kind(a.sequence), .format = format};
  options.seed = parse_count(a.seed);
  options.origin = std::filesystem::path(a.model).filename().string();
  const auto model = session.timed("read", [&] { return load_source_model(a.model); });
  const auto warnings =
      session.timed("write", [&] { return sample(*model, n, a.output, options, session.progress()); });
  for (const std::string& warning : warnings) session.note(fmt::format("{}: {}", a.output, warning));
  session.print_line(fmt::format("{}: {} rays of {:g} {} as {}, {:.1f} M rays/s", a.output, n, model->flux(),
                                 symbol(model->flux_unit()), format,
                                 1e-6 * static_cast<double>(n) / session.seconds("write")));
}

}  // namespace

void add_sample(CLI::App& app, Session& session, int&) {
  Command command(app, "sample", "Draw rays from a model");
  auto arguments = std::make_shared<SampleArguments>();
  SampleArguments& a = *arguments;
  command.required("MODEL", a.model, "A model file (.nfl)");
  command.required("-o,--output", a.output, "The ray file to write");
  command.required("-n,--rays", a.count, "Number of rays");
  command.option("--to", a.to, "Format of the file (default: by its ending)");
  command.option("--seed", a.seed, "Seed of the random numbers");
  command.option("--sequence", a.sequence, "random or sobol");
  session.add_common(command);
  command.on_run([arguments, &session] { run_sample(*arguments, session); });
}

}  // namespace lucerna::cli
