// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/model_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/subset.h"
#include "lucerna/report/report_model.h"

namespace lucerna::cli {

namespace {

constexpr std::uint64_t kMaxRays = std::uint64_t{1} << 22;

/// A choice of a file's rays, their weights scaled to what all of them carry: `flux` in all.
void append_choice(RayBlock& out, RayReader& reader, std::uint64_t wanted, std::optional<double> flux,
                   Progress& progress) {
  const RaySubset subset(reader.ray_count(), wanted, 1);
  RayBlock chosen;
  std::uint64_t first = 0;
  for_each_block(reader, progress, "report: rays", [&](const RayBlock& block) {
    RayBlock bare = block;
    bare.extra.clear();
    subset.select(bare, first, chosen);
    first += block.size();
  });
  const double sum = std::accumulate(chosen.weight.begin(), chosen.weight.end(), 0.0);
  if (flux && sum > 0.0) {
    for (float& w : chosen.weight) w = static_cast<float>(static_cast<double>(w) * *flux / sum);
  }
  out.append(chosen);
}

}  // namespace

void write_model_report(const SourceModel& model, const std::string& model_path,
                        const std::vector<std::string>& ray_paths, Json json, const std::string& output,
                        Session& session) {
  std::vector<std::unique_ptr<RayReader>> readers;
  std::uint64_t all = 0;
  for (const std::string& path : ray_paths) {
    readers.push_back(open_ray_file(path));
    all += readers.back()->ray_count();
  }
  RayBlock rays;
  for (const auto& reader : readers) {
    const double part =
        static_cast<double>(std::min(all, kMaxRays)) / static_cast<double>(std::max<std::uint64_t>(all, 1));
    const auto wanted = static_cast<std::uint64_t>(part * static_cast<double>(reader->ray_count()));
    // Only several files need their fluxes: within one the weights are enough.
    const std::optional<double> flux = readers.size() > 1 ? reader->header().flux() : std::nullopt;
    append_choice(rays, *reader, wanted, flux, session.progress());
  }
  ModelReportOptions options;
  options.title = std::filesystem::path(model_path).filename().string();
  options.rays = ray_paths.empty() ? nullptr : &rays;
  options.rays_in_files = all;
  write_file(output, model_report_html(model, std::move(json), options, session.progress()));
  session.say(fmt::format("  report: {}, {:.2f} MB", output,
                          1e-6 * static_cast<double>(std::filesystem::file_size(output))));
}

}  // namespace lucerna::cli
