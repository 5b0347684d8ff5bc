// SPDX-License-Identifier: Apache-2.0
#include "lucerna/held_out.h"

#include <algorithm>
#include <utility>

#include "lucerna/error.h"
#include "lucerna/rayset/comparison/scale_counts.h"
#include "lucerna/rayset/data/halves.h"
#include "lucerna/rayset/files/thinned_ray_set.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace lucerna {

namespace {

constexpr std::size_t kFewestRays = 100;
/// Of the model at least so many rays are drawn, so that its own noise does not hide what is to be seen.
constexpr std::size_t kFewestDrawn = std::size_t{1} << 20;
/// Random numbers beside those that `compress` uses.
constexpr std::uint64_t kDrawnSeed = 0x6f7574;

}  // namespace

std::optional<HeldOutComparison> compare_held_out(const RaySet& rays, const CompressOptions& options,
                                                  Progress& progress) {
  auto [first_half, held_out] = ray_halves(rays.rays, options.seed);
  const RaySet training{rays.header, std::move(first_half)};
  for (const RayBlock* half : {&training.rays, &std::as_const(held_out)})
    if (half->size() < kFewestRays || !has_flux(*half)) return std::nullopt;

  const auto model = compress(training, options, progress);
  progress.step("compress: held-out rays", 0, 1);
  const RayBlock drawn = draw_rays(*model, Sequence(SequenceKind::random, options.seed ^ kDrawnSeed),
                                   std::max(kFewestDrawn, held_out.size()));
  const Views views(held_out);
  HeldOutComparison found{training.rays.size(), held_out.size(), {}, {}};
  ViewCounts of_held_out(views), of_model(views), of_training(views);
  ScaleCounts scales_held_out(views), scales_model(views), scales_training(views);
  of_held_out.add(held_out), scales_held_out.add(held_out);
  of_model.add(drawn), scales_model.add(drawn);
  of_training.add(training.rays), scales_training.add(training.rays);
  found.views = compare_view_counts(of_held_out, of_model, &of_training);
  found.scales = compare_scales(scales_held_out, scales_model, scales_training);
  return found;
}

std::optional<HeldOutComparison> compare_held_out(const std::vector<std::filesystem::path>& files,
                                                  std::uint64_t max_rays, const CompressOptions& options,
                                                  Progress& progress) {
  if (files.empty()) throw UsageError("no ray file to compress");
  return compare_held_out(thinned_ray_set(files, {.max_rays = max_rays, .seed = options.seed}, progress).set,
                          options, progress);
}

}  // namespace lucerna
