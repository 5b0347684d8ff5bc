// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/merge_ray_sets.h"
#include "lucerna/rayset/files/named_warnings.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source_model.h"

namespace lucerna {

namespace {

/// One file, adaptively, block by block.
CompressedFiles compress_stream(const std::filesystem::path& file, const CompressOptions& options,
                                Progress& progress) {
  const AdaptiveOptions adaptive{.max_bytes = options.max_bytes, .seed = options.seed, .flux = options.flux};
  const auto reader = open_ray_file(file);
  if (!options.flux) require_flux(reader->header(), file.string());
  CompressedFiles made;
  made.rays = reader->ray_count();
  if (made.rays > adaptive.max_rays) {
    made.notes.push_back(fmt::format("{}: of its {} rays {} are used, one of each stretch of equal length",
                                     file.string(), made.rays, adaptive.max_rays));
  }
  made.model = compress_adaptive(*reader, adaptive, progress);
  add_named_warnings(file, reader->warnings(), made.warnings);
  return made;
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

std::unique_ptr<SourceModel> compress(const RaySet& rays, const CompressOptions& options,
                                      Progress& progress) {
  if (options.method == CompressMethod::adaptive) {
    return compress_adaptive(
        rays, {.max_bytes = options.max_bytes, .seed = options.seed, .flux = options.flux}, progress);
  }
  return compress_clusters(rays, {.max_bytes = options.max_bytes, .seed = options.seed, .flux = options.flux},
                           progress);
}

CompressedFiles compress(const std::vector<std::filesystem::path>& files, const CompressOptions& options,
                         Progress& progress) {
  if (files.empty()) throw UsageError("no ray file to compress");
  if (files.size() == 1 && options.method == CompressMethod::adaptive) {
    return compress_stream(files.front(), options, progress);
  }
  CompressedFiles made;
  RaySet all;
  for (const std::filesystem::path& file : files) {
    std::vector<std::string> warnings;
    RaySet rays = read_ray_set(file, {}, progress, &warnings);
    add_named_warnings(file, warnings, made.warnings);
    if (files.size() == 1) {
      all = std::move(rays);
    } else {
      merge_ray_sets(all, std::move(rays), file.string());
    }
  }
  if (options.flux) all.header.set_flux(*options.flux);
  require_flux(all.header, files.front().string());
  made.rays = all.rays.size();
  made.model = compress(all, options, progress);
  return made;
}

}  // namespace lucerna
