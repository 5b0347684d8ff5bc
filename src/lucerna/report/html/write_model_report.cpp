// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/write_model_report.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/files/thinned_ray_set.h"
#include "lucerna/report/html/report_model.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxReportRays = std::uint64_t{1} << 22;

}  // namespace

void write_model_report(const SourceModel& model, const std::filesystem::path& model_path,
                        const std::vector<std::filesystem::path>& ray_files, nlohmann::ordered_json json,
                        const std::filesystem::path& html, Progress& progress) {
  const ThinnedRaySet rays = thinned_ray_set(ray_files, {.max_rays = kMaxReportRays}, progress);
  ModelReportOptions options;
  options.title = model_path.filename().string();
  options.rays = ray_files.empty() ? nullptr : &rays.set.rays;
  options.rays_in_files = rays.of;
  write_file(html, model_report_html(model, std::move(json), options, progress));
}

}  // namespace lucerna
