// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/files/thinned_ray_set.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/model/compress_files.h"
#include "lucerna/source_model.h"

namespace lucerna {

namespace {

ThinOptions thin_options(const CompressOptions& options, Peers* peers) {
  ThinOptions thin{.seed = options.seed, .only_wavelengths = true, .peers = peers};
  if (options.method == CompressMethod::adaptive) thin.max_rays = options.max_rays_in_memory;
  return thin;
}

/// What of the rays' colours the model will not have, as a sentence; empty for nothing.
std::string dropped_colours(const RaySet& set, CompressMethod method) {
  const RayWavelengths wavelengths(set.header, set.header.flux_unit);
  if (!wavelengths.are_known()) return {};
  if (method == CompressMethod::clusters) return "clusters have no colours: those of the rays are dropped";
  if (!wavelengths.column()) return {};
  const auto& nm = set.rays.extra.at(*wavelengths.column());
  const auto unknown = std::ranges::count_if(nm, [](float x) { return !(x > 0.0F); });
  if (unknown == 0) return {};
  return fmt::format("{} of {} rays have no wavelength: the colours of all are dropped", unknown, nm.size());
}

}  // namespace

std::string_view to_string(CompressMethod method) {
  return method == CompressMethod::adaptive ? "adaptive" : "clusters";
}

CompressMethod compress_method(std::string_view name) {
  if (name == "adaptive") return CompressMethod::adaptive;
  if (name == "clusters") return CompressMethod::clusters;
  throw UsageError(fmt::format("unknown method '{}'; expected adaptive or clusters", name));
}

namespace {

/// `all_rays`: as AdaptiveOptions has them.
std::unique_ptr<SourceModel> compress(const RaySet& rays, const CompressOptions& options, RayStream all_rays,
                                      Progress& progress) {
  if (options.method == CompressMethod::adaptive) {
    return compress_adaptive(rays,
                             {.max_bytes = options.max_bytes,
                              .seed = options.seed,
                              .flux = options.flux,
                              .all_rays = std::move(all_rays)},
                             progress);
  }
  return compress_clusters(rays, {.max_bytes = options.max_bytes, .seed = options.seed, .flux = options.flux},
                           progress);
}

}  // namespace

std::unique_ptr<SourceModel> compress(const RaySet& rays, const CompressOptions& options,
                                      Progress& progress) {
  return compress(rays, options, {}, progress);
}

CompressedFiles compress_files(const std::vector<std::filesystem::path>& files,
                               const CompressOptions& options, Peers* peers, Progress& progress) {
  if (files.empty()) throw UsageError("no ray file to compress");
  // Before much is read.
  if (!options.flux && peers == nullptr)
    require_flux(open_ray_file(files.front())->header(), files.front().string());
  if (options.max_rays_in_memory < 1)
    throw UsageError("found no ray that may be in memory, expected 1 or more");
  const ThinOptions thin = thin_options(options, peers);
  ThinnedRaySet read = thinned_ray_set(files, thin, progress);
  if (options.flux) read.set.header.set_flux(*options.flux);
  require_flux(read.set.header, files.front().string());
  CompressedFiles made;
  made.rays = read.of;
  made.warnings = std::move(read.warnings);
  RayStream all_rays;
  if (read.set.rays.size() < read.of) {
    all_rays = [&](const auto& use) { for_each_ray_block(files, use, progress); };
    made.notes.push_back(fmt::format(
        "{}: {} of {} rays, one of each stretch of equal length, say where the model's pieces lie; "
        "all of them say how bright these are",
        files.size() == 1 ? files.front().string() : "all files", read.set.rays.size(), read.of));
  }
  if (std::string dropped = dropped_colours(read.set, options.method); !dropped.empty())
    made.warnings.push_back(std::move(dropped));
  made.model = compress(read.set, options, std::move(all_rays), progress);
  return made;
}

CompressedFiles compress(const std::vector<std::filesystem::path>& files, const CompressOptions& options,
                         Progress& progress) {
  return compress_files(files, options, nullptr, progress);
}

}  // namespace lucerna
