// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/compare_parts.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/input_kind.h"
#include "lucerna/core/io/error.h"
#include "lucerna/held_out.h"
#include "lucerna/report/html/write_model_report.h"
#include "lucerna/results/json/views_json.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

struct CompressArguments {
  std::vector<std::string> inputs;
  std::string output, method = "adaptive", max_bytes, flux, seed = "1", held_out = "2e6", report;
};

std::optional<double> given_flux(const CompressArguments& a) {
  if (a.flux.empty()) return std::nullopt;
  const double flux = parse_number(a.flux);
  if (!(flux > 0.0)) throw UsageError(fmt::format("--flux {} is not > 0", a.flux));
  return flux;
}

CompressOptions compress_options(const CompressArguments& a) {
  CompressOptions options{.method = compress_method(a.method), .flux = given_flux(a)};
  if (!a.max_bytes.empty()) options.max_bytes = parse_size(a.max_bytes);
  options.seed = parse_count(a.seed);
  return options;
}

/// Other programs, and `check` of a folder, know a source model by its ending.
void check_output(const CompressArguments& a) {
  if (std::filesystem::path(a.output).extension() != ".nfl")
    throw UsageError(fmt::format("{}: a source model is written, expected the ending .nfl", a.output));
  require_writable(a.output);
  require_writable(a.report);
}

CompressedFiles make_model(const CompressArguments& a, Session& session) {
  const CompressOptions options = compress_options(a);
  CompressedFiles made = compress({a.inputs.begin(), a.inputs.end()}, options, session.progress());
  for (const std::string& input : a.inputs) session.add_input(input);
  for (const std::string& note : made.notes) session.note(note);
  for (const std::string& warning : made.warnings) {
    if (session.strict) throw InputError(warning);
    session.note(warning);
  }
  return made;
}

/// Says and notes how far the model is to be trusted, if there are rays enough to say so.
void judge(const CompressArguments& a, std::uint64_t max_rays, Json& json, Session& session) {
  if (max_rays == 0) return;
  const auto found = session.timed("held-out", [&] {
    return compare_held_out({a.inputs.begin(), a.inputs.end()}, max_rays, compress_options(a),
                            session.progress());
  });
  if (!found) return;
  json["held_out"] = held_out_json(*found);
  print_held_out(*found, session);
}

void run_compress(const CompressArguments& a, Session& session) {
  session.start();
  check_output(a);
  for (const std::string& input : a.inputs) require_ray_file(input);
  const std::uint64_t held_out = parse_count(a.held_out);
  const auto made = session.timed("compress", [&] { return make_model(a, session); });
  const SourceModel* model = made.model.get();
  const std::uint64_t rays = made.rays;
  const std::uint64_t bytes = session.timed("write", [&] { return save_source_model(a.output, *model); });
  Json json = session.json_head(parse_count(a.seed));
  json["method"] = std::string(model->method());
  json["rays"] = rays;
  json["bytes"] = bytes;
  json["layers"] = model->layers();
  json["leaves"] = model->leaves();
  json[model->flux_unit() == FluxUnit::lumen ? "flux_lm" : "flux_w"] = model->flux();
  const double ratio = 28.0 * static_cast<double>(rays) / static_cast<double>(bytes);
  session.print_line(fmt::format(
      "{}: {} rays to {} bytes ({}), method {}, {} layer(s), {} leaves, {:g} {}; {:.3g} s", a.output, rays,
      bytes, ratio >= 1.0 ? fmt::format("{:.3g} times smaller", ratio) : "larger than the rays themselves",
      model->method(), model->layers(), model->leaves(), model->flux(), symbol(model->flux_unit()),
      session.seconds("compress")));
  judge(a, held_out, json, session);
  session.print_json(json);
  if (a.report.empty()) return;
  write_model_report(*model, a.output, {a.inputs.begin(), a.inputs.end()}, std::move(json), a.report,
                     session.progress());
  session.print_line(fmt::format("  report: {}, {:.2f} MB", a.report,
                                 1e-6 * static_cast<double>(std::filesystem::file_size(a.report))));
}

}  // namespace

void add_compress(CLI::App& app, Session& session, int&) {
  Command command(app, "compress", "Make a small source model of ray files");
  auto arguments = std::make_shared<CompressArguments>();
  CompressArguments& a = *arguments;
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
  command.on_run([arguments, &session] { run_compress(*arguments, session); });
}

}  // namespace lucerna::cli
