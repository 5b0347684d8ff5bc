// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/trace/backward/backward_scene.h"
#include "lucerna/trace/backward/mirror_guide.h"
#include "lucerna/trace/backward/source_lines.h"

namespace lucerna {

/// What the backward estimators draw from: the scene, lines past each of its sources, and places on its
/// mirrors that reflect them. Immutable and thread safe; the scene must outlive it.
class BackwardSampler {
 public:
  /// Throws InputError with `no_backward_reason`, UsageError unless max_bounces >= 1.
  BackwardSampler(const Scene& scene, int max_bounces);

  const BackwardScene& scene() const { return scene_; }
  /// One for each source.
  const std::vector<LineDisks>& disks() const { return disks_; }
  const MirrorGuide& guide() const { return guide_; }

  /// Luminance times area across `start` of the light that leaves a place of a mirror along `start` and the
  /// luminaire by an exit, over the density of its draw: what one sample says of the intensity along the
  /// direction that it leaves in. 0 behind the mirror and in shadow.
  double intensity_sample(const MirrorPlace& place, const MirrorPoint& from, const Direction& start,
                          Exit exit, ReflectionKey key, BackwardScene::Scratch& scratch) const;

 private:
  BackwardScene scene_;
  std::vector<LineDisks> disks_;
  MirrorGuide guide_;
};

}  // namespace lucerna
