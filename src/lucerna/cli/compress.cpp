// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/arguments.h"
#include "lucerna/cli/commands.h"
#include "lucerna/cli/model_report.h"
#include "lucerna/core/error.h"
#include "lucerna/rayset/ray_file.h"
#include "lucerna/rayset/superpose.h"
#include "lucerna/source/adaptive_compress.h"
#include "lucerna/source/cluster_compress.h"

namespace lucerna::cli {

namespace {

struct CompressArguments {
  std::vector<std::string> inputs;
  std::string output, method = "adaptive", max_bytes, flux, seed = "1", report;
};

std::optional<double> given_flux(const CompressArguments& a) {
  if (a.flux.empty()) return std::nullopt;
  const double flux = parse_number(a.flux);
  if (!(flux > 0.0)) throw UsageError(fmt::format("--flux {} is not > 0", a.flux));
  return flux;
}

/// All inputs as one set; a given flux replaces what one file states, or scales the sum of several.
RaySet read_inputs(const CompressArguments& a, Session& session) {
  RaySet all;
  std::vector<std::string> warnings;
  for (const std::string& path : a.inputs) {
    RaySet set = read_ray_set(path, {}, session.progress(), &warnings);
    session.add_input(path);
    if (a.inputs.size() == 1) {
      all = std::move(set);
    } else {
      superpose(all, std::move(set), path);
    }
  }
  for (const std::string& warning : warnings) {
    if (session.strict) throw InputError(warning);
    session.note(warning);
  }
  if (const auto flux = given_flux(a)) all.header.set_flux(*flux);
  require_flux(all.header, a.inputs.front());
  return all;
}

/// A model and the rays it was made from.
struct Compressed {
  std::unique_ptr<SourceModel> model;
  std::uint64_t rays = 0;
};

/// One file, adaptively: block by block, so that it may be larger than memory.
Compressed compress_stream(const CompressArguments& a, const AdaptiveOptions& options, Session& session) {
  const auto reader = open_ray_file(a.inputs.front());
  session.add_input(a.inputs.front());
  if (reader->ray_count() > options.most_rays) {
    session.note(fmt::format("{}: of its {} rays {} are used, one of each stretch of equal length",
                             a.inputs.front(), reader->ray_count(), options.most_rays));
  }
  Compressed made{compress_adaptive(*reader, options, session.progress()), reader->ray_count()};
  for (const std::string& warning : reader->warnings()) {
    if (session.strict) throw InputError(warning);
    session.note(warning);
  }
  return made;
}

Compressed make_model(const CompressArguments& a, Session& session) {
  if (a.method != "adaptive" && a.method != "clusters") {
    throw UsageError(fmt::format("unknown method '{}'; expected adaptive or clusters", a.method));
  }
  std::optional<std::uint64_t> max_bytes;
  if (!a.max_bytes.empty()) max_bytes = parse_size(a.max_bytes);
  const std::uint64_t seed = parse_count(a.seed);
  if (a.method == "adaptive" && a.inputs.size() == 1) {
    return compress_stream(a, {.max_bytes = max_bytes, .seed = seed, .flux = given_flux(a)}, session);
  }
  const RaySet rays = session.timed("read", [&] { return read_inputs(a, session); });
  if (a.method == "adaptive") {
    return {compress_adaptive(rays, {.max_bytes = max_bytes, .seed = seed}, session.progress()),
            rays.rays.size()};
  }
  return {compress_clusters(rays, {.max_bytes = max_bytes, .seed = seed}, session.progress()),
          rays.rays.size()};
}

void compress(const CompressArguments& a, Session& session) {
  session.start();
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
  session.print_json(json);
  const double ratio = 28.0 * static_cast<double>(rays) / static_cast<double>(bytes);
  session.say(fmt::format(
      "{}: {} rays to {} bytes ({:.3g} times smaller), method {}, {} layer(s), {} leaves, {:g} {}; {:.3g} s",
      a.output, rays, bytes, ratio, model->method(), model->layers(), model->leaves(), model->flux(),
      symbol(model->flux_unit()), session.seconds("compress")));
  if (!a.report.empty()) write_model_report(*model, a.output, a.inputs, std::move(json), a.report, session);
}

}  // namespace

void add_compress(CLI::App& app, Session& session, int&) {
  Command command(app, "compress", "Make a small source model of ray files");
  auto arguments = std::make_shared<CompressArguments>();
  CompressArguments& a = *arguments;
  command.required("IN", a.inputs, "Ray files; several are superposed, their fluxes add");
  command.required("-o,--output", a.output, "The model file to write (.nfl)");
  command.option("--method", a.method, "adaptive, or clusters: the seed's anisotropic point lights");
  command.option("--max-bytes", a.max_bytes, "Largest size of the file (64k, 1MB, 64KiB)");
  command.option("--flux", a.flux, "Total flux, in the rays' unit, instead of what the files state");
  command.option("--seed", a.seed, "Seed of the random choices");
  command.option("--report", a.report, "Also write the report as one HTML file");
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run([arguments, &session] { compress(*arguments, session); });
}

}  // namespace lucerna::cli
