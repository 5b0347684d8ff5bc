// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "scene.h"
#include "tally.h"
#include "task.h"

namespace bench {

struct TraceSettings {
  std::uint64_t rays = 100'000'000, seed = 1;
  unsigned threads = 1;
};

/// Rays are numbered; ray i is of replicate (i / kRun) % 16 and has its own random numbers. So the tally is
/// the same to the bit for any number of threads. Rays are raised to a multiple of 16 * kRun for emitters;
/// all rays of a file are traced, whatever their number.
inline constexpr std::uint64_t kRun = 1024;
std::uint64_t whole_rays(std::uint64_t rays, const Source& source);

Tally trace(const Task& task, const Source& source, const SurfaceScene& scene, const Target& target,
            const TraceSettings& settings);

/// Share of unpolarised light that an interface reflects (Fresnel), and the refracted direction; a share of 1
/// for total reflection. `cosine` > 0 on the side of index n1; `normal` against the ray.
struct Refraction {
  double reflected = 1.0;
  Vec3 direction;
};
Refraction refract(const Vec3& direction, const Vec3& normal, double n1, double n2);

}  // namespace bench
