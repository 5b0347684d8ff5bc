// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/ray_check.h"

#include <cmath>

#include "lucerna/core/io/diagnostic_text.h"
#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"

namespace lucerna {

namespace {

void check_totals(const RaySetHeader& header, const RaySummary& summary, std::vector<Diagnostic>& found) {
  const auto warn = [&](std::string text) { found.push_back({Severity::warning, "", std::move(text)}); };
  if (summary.count == 0) return warn("no rays");
  if (!(summary.weight_sum > 0.0)) found.push_back({Severity::error, "", "no ray carries flux"});
  const auto flux = header.flux();
  if (!flux)
    return warn(
        fmt::format("no total flux in {} is stated: it will have to be given", symbol(header.flux_unit)));
  if (std::abs(summary.weight_sum / *flux - 1.0) > 1e-3) {
    warn(fmt::format(
        "the rays' flux sums to {:.6g} {unit}, {:.6g} {unit} is stated: the rays share the stated flux",
        summary.weight_sum, *flux, fmt::arg("unit", symbol(header.flux_unit))));
  }
}

}  // namespace

std::vector<Diagnostic> check_ray_file(const std::filesystem::path& path, const ReadOptions& options,
                                       Progress& progress) {
  std::vector<Diagnostic> found;
  const auto pass = [&](bool salvage) {
    ReadOptions how = options;
    how.salvage = salvage;
    const auto reader = open_ray_file(path, how);
    RayStatistics statistics;
    for_each_block(*reader, progress, "check", [&](const RayBlock& block) { statistics.add(block); });
    for (const std::string& warning : reader->warnings())
      found.push_back(diagnostic(Severity::warning, warning));
    if (reader->dropped() > 0)
      found.push_back({Severity::error, "", fmt::format("{} faulty rays", reader->dropped())});
    check_totals(reader->header(), statistics.result(), found);
  };
  try {
    pass(false);
    return found;
  } catch (const InputError& error) {
    found = {diagnostic(error, path)};
  }
  // What a first error hides: the file is read again as far as it can be.
  try {
    pass(true);
  } catch (const InputError&) {
    found.resize(1);
  }
  return found;
}

}  // namespace lucerna
