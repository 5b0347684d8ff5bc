// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/source.h"
#include "lucerna/source/emitters/luminance_source.h"

namespace lucerna {

/// An emitter's kind with its sizes; those that the kind has not count for nothing.
struct EmitterShape {
  EmitterKind kind = EmitterKind::point;
  double radius_mm = 0.0, length_mm = 0.0, width_mm = 0.0, height_mm = 0.0, ghost_share = 0.0;
};

/// Is the luminance of this kind known in closed form? Disk, rectangle, cylinder, sphere, led.
bool emitter_has_luminance(EmitterKind kind);

/// The light on a ray's line, starting where it is emitted; nothing on lines without light, and for kinds
/// without a luminance.
std::optional<LineLight> emitter_light(const EmitterShape& shape, const Ray& ray);

/// Distance from the origin that no emitting point of a kind with a luminance is beyond.
double emitter_reach_mm(const EmitterShape& shape);

}  // namespace lucerna
