// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/cli/commands.h"
#include "lucerna/cli/compare_parts.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/design/box_error.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/report/error_json.h"
#include "lucerna/report/svg_polar.h"
#include "lucerna/report/trace_folder.h"
#include "lucerna/report/trace_json.h"

namespace lucerna::cli {

void write_comparison(const CompareArguments& a, const Json& json, Session& session) {
  session.print_json(json);
  if (a.output.empty()) return;
  write_file(std::filesystem::path(a.output) / "result.json",
             json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

namespace {

/// A light distribution to compare, with the standard errors of its values where they are known.
FarFieldTable read_distribution(const std::string& path, const CompareArguments& a, Session& session) {
  if (!std::filesystem::is_directory(path)) {
    session.add_input(path);
    return {path, read_photometric_file(path, a.photometric.read_options(session.strict)).distribution, {}};
  }
  session.add_input(std::filesystem::path(path) / "result.json");
  TraceFolder folder = read_trace_folder(path);
  if (folder.far_fields.empty()) throw InputError(fmt::format("{}: the trace has no far field", path));
  return std::move(folder.far_fields.front());
}

void say_comparison(const DesignError& boxes, const DistributionComparison& c, Session& session) {
  session.say(fmt::format(
      "  error as a design   {:.4g} % in 48 x 48 boxes over A's rectangle{} (24: {:.4g}, 12: {:.4g}), by "
      "shape",
      100.0 * boxes.c48.excess,
      std::isnan(boxes.c48.standard_error) ? ""
                                           : fmt::format(" +- {:.2g} %", 100.0 * boxes.c48.standard_error),
      100.0 * boxes.c24.excess, 100.0 * boxes.c12.excess));
  const auto percent = [](const Estimate& e) {
    return estimate_text({100.0 * e.mean, 100.0 * e.standard_error}, "%");
  };
  session.say(fmt::format("  relative RMS        {} (noise floor {:.4g} %, excess {:.4g} %)",
                          percent(c.rms()), 100.0 * c.noise_floor, 100.0 * c.excess));
  session.say(fmt::format("  Bergen fit          {} (100 = equal; by solid angle), {} unweighted",
                          estimate_text(c.bergen()), estimate_text(c.bergen_unweighted())));
  session.say(
      fmt::format("  flux, peak          {}, {} times", estimate_text(c.flux()), estimate_text(c.peak())));
  session.say(fmt::format("  Wasserstein-1       {}", estimate_text(c.wasserstein(), "deg")));
  session.say(
      fmt::format("  overlap             {} of the flux in the right place", percent(c.overlapping())));
  if (c.alignment) {
    session.say(fmt::format(
        "  best alignment      tilt {:.3g} deg toward C {:.0f}, turn {:.3g} deg; then relative RMS {:.4g} %",
        c.alignment->tilt_deg, c.alignment->tilt_toward_c_deg, c.alignment->turn_deg,
        100.0 * c.alignment->relative_rms));
  }
}

void compare_photometry(const CompareArguments& a, Session& session) {
  const FarFieldTable reference =
      session.timed("read", [&] { return read_distribution(a.reference, a, session); });
  const FarFieldTable test = session.timed("read", [&] { return read_distribution(a.test, a, session); });
  const DistributionComparison c = session.timed("compare", [&] {
    return compare_distributions(
        reference.distribution, test.distribution,
        {.reference_error_cd = reference.standard_error, .test_error_cd = test.standard_error});
  });
  const DesignError boxes = session.timed("boxes", [&] {
    return box_error(reference.distribution, test.distribution, TargetMode::shape, test.standard_error);
  });
  Json json = session.json_head(std::nullopt);
  json["relative_rms"] = estimate_json(c.rms());
  json["bergen_fit"] = estimate_json(c.bergen());
  json["bergen_fit_unweighted"] = estimate_json(c.bergen_unweighted());
  json["flux_ratio"] = estimate_json(c.flux());
  json["peak_ratio"] = estimate_json(c.peak());
  json["wasserstein_deg"] = estimate_json(c.wasserstein());
  json["overlap"] = estimate_json(c.overlapping());
  json["floor"] = c.noise_floor;
  json["excess"] = c.excess;
  json["error"] = error_json(boxes);
  json["outside"] = outside_json(boxes);
  json["worst_cell"] = estimate_json(boxes.worst_cell);
  if (c.alignment) {
    json["alignment"] = {{"tilt_deg", c.alignment->tilt_deg},
                         {"tilt_toward_c_deg", c.alignment->tilt_toward_c_deg},
                         {"turn_deg", c.alignment->turn_deg},
                         {"relative_rms", c.alignment->relative_rms}};
  }
  if (!a.output.empty()) {
    write_file(std::filesystem::path(a.output) / "polar.svg",
               polar_svg(test.distribution,
                         {.title = std::filesystem::path(a.test).filename().string(),
                          .reference = &reference.distribution,
                          .reference_name = std::filesystem::path(a.reference).filename().string()}));
  }
  write_comparison(a, json, session);
  session.say(fmt::format("{} against {}", a.test, a.reference));
  say_comparison(boxes, c, session);
}

void compare(const CompareArguments& a, Session& session) {
  session.start();
  const auto is_distribution = [](const std::string& path) {
    return std::filesystem::is_directory(path) || is_photometric_file(path);
  };
  const bool photometric = is_distribution(a.reference);
  if (photometric != is_distribution(a.test)) {
    throw InputError(fmt::format("{}: a photometric file and a ray file or model cannot be compared",
                                 photometric ? a.reference : a.test));
  }
  if (!a.output.empty()) prepare_folder(a.output, session.force);
  if (photometric) {
    compare_photometry(a, session);
  } else {
    compare_rays(a, session);
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
  command.on_run([arguments, &session] { compare(*arguments, session); });
}

}  // namespace lucerna::cli
