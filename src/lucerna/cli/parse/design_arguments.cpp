// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/design_arguments.h"

#include <fmt/format.h>

#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"

namespace lucerna::cli {

void add_design_options(Command& command, DesignArguments& a, Session& session, bool device) {
  command.required("PROJECT", a.project, "Project file with [target] and [design]");
  command.required("-o,--output", a.output, "Folder for the results");
  command.option("--time", a.time,
                 "Seconds after which to have stopped with the best so far (default: the project's time_s)");
  command.option("--rays", a.rays,
                 "Rays of the finest evaluations, at least 8192, and up to four times as many to validate "
                 "(default 2^23 and 2^24). N for a lens: N/2, and N to validate");
  command.option("--seed", a.seed, "Seed of the random numbers");
  if (device) command.option("--device", a.device, "cpu, cuda or auto");
  command.option("--report", a.report, "Also write the report as one HTML file");
  command.flag("--tolerances", a.tolerances, "Try what a misplaced source and an inexact mirror change");
  command.flag("--pareto", a.pareto,
               "Also the trade between error and light, after the time; only of free forms and troughs");
  command.flag("--advise", a.advise,
               "Also design it wider, with half the hole, as another family, ..., each for the same time");
  command.flag("--resume", a.resume, "Go on from the folder's checkpoint");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
}

DesignOptions design_options(const DesignArguments& a) {
  DesignOptions options;
  options.seed = parse_count(a.seed);
  options.pareto = a.pareto;
  options.advise = a.advise;
  if (!a.time.empty()) {
    options.time_s = parse_number(a.time);
    if (!(*options.time_s > 0.0)) throw UsageError(fmt::format("--time {} is not > 0", a.time));
  }
  if (!a.rays.empty()) {
    options.max_rays = parse_count(a.rays);
    options.validation_rays = 4 * options.max_rays;
    check(options);
  }
  return options;
}

}  // namespace lucerna::cli
