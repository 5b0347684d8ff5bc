// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/write_model_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/subset.h"
#include "lucerna/report/html/report_model.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxReportRays = std::uint64_t{1} << 22;

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

void write_model_report(const SourceModel& model, const std::filesystem::path& model_path,
                        const std::vector<std::filesystem::path>& ray_files, nlohmann::ordered_json json,
                        const std::filesystem::path& html, Progress& progress) {
  std::vector<std::unique_ptr<RayReader>> readers;
  std::uint64_t all = 0;
  for (const std::filesystem::path& path : ray_files) {
    readers.push_back(open_ray_file(path));
    all += readers.back()->ray_count();
  }
  RayBlock rays;
  for (const auto& reader : readers) {
    const double part = static_cast<double>(std::min(all, kMaxReportRays)) /
                        static_cast<double>(std::max<std::uint64_t>(all, 1));
    const auto wanted = static_cast<std::uint64_t>(part * static_cast<double>(reader->ray_count()));
    // Only several files need their fluxes: within one the weights are enough.
    const std::optional<double> flux = readers.size() > 1 ? reader->header().flux() : std::nullopt;
    append_choice(rays, *reader, wanted, flux, progress);
  }
  ModelReportOptions options;
  options.title = model_path.filename().string();
  options.rays = ray_files.empty() ? nullptr : &rays;
  options.rays_in_files = all;
  write_file(html, model_report_html(model, std::move(json), options, progress));
}

}  // namespace lucerna
