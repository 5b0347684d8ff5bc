// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_sampler.h"

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

int checked(int max_bounces) {
  if (max_bounces < 1) throw UsageError(fmt::format("{} bounces: expected at least 1", max_bounces));
  return max_bounces;
}

std::vector<LineDisks> disks_of(const Scene& scene, const BackwardScene& backward) {
  std::vector<LineDisks> disks;
  for (std::size_t i = 0; i < scene.sources.size(); ++i)
    disks.emplace_back(scene.sources[i], *backward.sources()[i].light);
  return disks;
}

}  // namespace

BackwardSampler::BackwardSampler(const Scene& scene, int max_bounces)
    : scene_(scene, checked(max_bounces)), disks_(disks_of(scene, scene_)), guide_(scene_, disks_) {}

double BackwardSampler::intensity_sample(const MirrorPlace& place, const MirrorPoint& from,
                                         const Direction& start, Exit exit, ReflectionKey key,
                                         BackwardScene::Scratch& scratch) const {
  const double area = dot(from.area, start.vec());
  if (!(area > 0.0)) return 0.0;
  const double luminance = scene_.reflected_luminance(*from.mirror, from.point_mm, Direction::from(from.area),
                                                      start, exit, key, scratch);
  if (!(luminance > 0.0)) return 0.0;
  return luminance * area / place.pdf_plane * scene_.leaving_share(from.point_mm, start, exit, true, key);
}

}  // namespace lucerna
