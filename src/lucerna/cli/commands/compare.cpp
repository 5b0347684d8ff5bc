// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/compare_parts.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/file.h"
#include "lucerna/results/json/error_json.h"
#include "lucerna/results/json/trace_json.h"

namespace lucerna::cli {

namespace {

void print_comparison(const DesignError& boxes, const DistributionComparison& c, Session& session) {
  session.print_line(fmt::format(
      "  error as a design   {:.4g} % in 48 x 48 boxes over A's rectangle{} (24: {:.4g}, 12: {:.4g}), by "
      "shape",
      100.0 * boxes.c48.excess,
      std::isnan(boxes.c48.standard_error) ? ""
                                           : fmt::format(" +- {:.2g} %", 100.0 * boxes.c48.standard_error),
      100.0 * boxes.c24.excess, 100.0 * boxes.c12.excess));
  const std::string noise =
      c.noise_floor > 0.0
          ? fmt::format("noise floor {:.4g} %, excess {}", 100.0 * c.noise_floor, share_text(c.excess))
          : std::string("intensities as they are; the files state no noise");
  session.print_line(fmt::format("  relative RMS        {} ({})", share_text(c.relative_rms), noise));
  session.print_line(fmt::format("  Bergen fit          {} (100 = equal; by solid angle), {} unweighted",
                                 estimate_text(c.bergen_fit), estimate_text(c.bergen_fit_unweighted)));
  session.print_line(fmt::format("  flux, peak          {}, {} times", estimate_text(c.flux_ratio),
                                 estimate_text(c.peak_ratio)));
  session.print_line(fmt::format("  Wasserstein-1       {}", estimate_text(c.wasserstein_deg, "deg")));
  session.print_line(
      fmt::format("  overlap             {} of the flux in the right place", share_text(c.overlap)));
  if (c.alignment) {
    const Alignment& a = *c.alignment;
    // Its error is that of any turn where all fit alike.
    const std::string turn =
        a.turn_deg.standard_error > 90.0 ? "not determined" : estimate_text(a.turn_deg, "deg");
    session.print_line(fmt::format(
        "  best alignment      tilt {} toward C {:.0f}, turn {}; then relative RMS {}",
        estimate_text(a.tilt_deg, "deg"), a.tilt_toward_c_deg.mean, turn, share_text(a.relative_rms)));
  }
}

Json light_json(const LightFileComparison& light) {
  const DistributionComparison& c = light.distributions;
  Json json;
  json["relative_rms"] = estimate_json(c.relative_rms);
  json["bergen_fit"] = estimate_json(c.bergen_fit);
  json["bergen_fit_unweighted"] = estimate_json(c.bergen_fit_unweighted);
  json["flux_ratio"] = estimate_json(c.flux_ratio);
  json["peak_ratio"] = estimate_json(c.peak_ratio);
  json["wasserstein_deg"] = estimate_json(c.wasserstein_deg);
  json["overlap"] = estimate_json(c.overlap);
  json["floor"] = c.noise_floor;
  json["excess"] = estimate_json(c.excess);
  json["error"] = error_json(light.boxes);
  json["outside"] = outside_json(light.boxes);
  json["worst_cell"] = estimate_json(light.boxes.worst_cell);
  if (c.alignment) {
    json["alignment"] = {{"tilt_deg", estimate_json(c.alignment->tilt_deg)},
                         {"tilt_toward_c_deg", estimate_json(c.alignment->tilt_toward_c_deg)},
                         {"turn_deg", estimate_json(c.alignment->turn_deg)},
                         {"relative_rms", estimate_json(c.alignment->relative_rms)}};
  }
  return json;
}

/// Notes a file of the comparison; of a trace's folder what it is read from.
void add_input(const std::filesystem::path& path, Session& session) {
  session.add_input(std::filesystem::is_directory(path) ? path / "result.json" : path);
}

FileComparisonOptions options_of(const CompareArguments& a, const Session& session) {
  FileComparisonOptions options;
  options.rays = parse_count(a.rays);
  options.seed = parse_count(a.seed);
  options.cells_um = parse_numbers(a.cells_um);
  options.photometric = a.photometric.read_options(session.strict);
  options.pictures = a.output;
  return options;
}

void print_json(const CompareArguments& a, const FileComparison& found, Session& session) {
  Json json = session.json_head(found.rays ? std::optional(parse_count(a.seed)) : std::nullopt);
  json.update(found.rays ? rays_json(*found.rays) : light_json(*found.light));
  session.print_json(json);
  if (a.output.empty()) return;
  write_file(std::filesystem::path(a.output) / "result.json",
             json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void compare_files(const CompareArguments& a, Session& session) {
  session.start();
  const FileComparisonOptions options = options_of(a, session);
  if (!a.output.empty()) session.prepare_folder(a.output, session.force);
  const FileComparison found =
      session.timed("compare", [&] { return compare(a.reference, a.test, options, session.progress()); });
  for (const std::string& warning : found.warnings) session.note(warning);
  add_input(a.reference, session);
  add_input(a.test, session);
  print_json(a, found, session);
  if (found.rays) {
    say_rays(a, *found.rays, session);
  } else {
    session.print_line(fmt::format("{} against {}", a.test, a.reference));
    print_comparison(found.light->boxes, found.light->distributions, session);
  }
}

}  // namespace

void add_compare(CLI::App& app, Session& session, int&) {
  Command command(app, "compare", "Compare two ray sets or models, or two photometric files");
  auto arguments = std::make_shared<CompareArguments>();
  CompareArguments& a = *arguments;
  command.required("A", a.reference, "Reference: a ray file, model, IES or EULUMDAT file, folder of a trace");
  command.required("B", a.test, "Test: likewise");
  command.option("--rays", a.rays, "Rays drawn from a model");
  command.option("--seed", a.seed, "Seed of those rays");
  command.option("-o,--output", a.output,
                 "Folder for result.json and pictures (luminance images; of light distributions polar.svg)");
  command.option("--cells-um", a.cells_um, "Cell sizes on the focus plane, um");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  a.photometric.add_read(command);
  session.add_json(command);
  session.add_strict(command);
  session.add_common(command);
  command.on_run([arguments, &session] { compare_files(*arguments, session); });
}

}  // namespace lucerna::cli
