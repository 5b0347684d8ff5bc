// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/compress_arguments.h"

#include <fmt/format.h>

#include <optional>

#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/input_kind.h"
#include "lucerna/core/io/error.h"

namespace lucerna::cli {

namespace {

std::optional<double> given_flux(const CompressArguments& a) {
  if (a.flux.empty()) return std::nullopt;
  const double flux = parse_number(a.flux);
  if (!(flux > 0.0)) throw UsageError(fmt::format("--flux {} is not > 0", a.flux));
  return flux;
}

}  // namespace

void add_compress_options(Command& command, CompressArguments& a, Session& session) {
  command.required("IN", a.inputs, "Ray files; several are superposed, their fluxes add");
  command.required("-o,--output", a.output, "The model file to write (.nfl)");
  command.option("--method", a.method, "adaptive, or clusters: Mas-Martin-Patow clusters");
  command.option("--max-bytes", a.max_bytes, "Largest size of the file (64k, 1MB, 64KiB)");
  command.option("--flux", a.flux, "Total flux, in the rays' unit, instead of what the files state");
  command.option("--seed", a.seed, "Seed of the random choices");
  command.option(
      "--held-out", a.held_out,
      "Rays by which the model is judged: one of half of them is compared with the other half; 0: none");
  command.option("--report", a.report, "Also write the report as one HTML file");
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
}

CompressOptions compress_options(const CompressArguments& a) {
  // Other programs, and `check` of a folder, know a source model by its ending.
  if (std::filesystem::path(a.output).extension() != ".nfl")
    throw UsageError(fmt::format("{}: a source model is written, expected the ending .nfl", a.output));
  parse_count(a.held_out);  // is used after the work, and refused before it
  CompressOptions options{.method = compress_method(a.method), .flux = given_flux(a)};
  if (!a.max_bytes.empty()) options.max_bytes = parse_size(a.max_bytes);
  options.seed = parse_count(a.seed);
  return options;
}

void check_compress(const CompressArguments& a) {
  require_writable(a.output);
  require_report(a.report);
  for (const std::string& input : a.inputs) require_ray_file(input);
}

}  // namespace lucerna::cli
