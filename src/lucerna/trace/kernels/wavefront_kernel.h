// SPDX-License-Identifier: Apache-2.0
#pragma once

// What happens to a batch of rays between their hits with mirrors: how they enter, what becomes of them
// at a reflection, and the closing of gaps. Included by the kernel_*.cpp files only, see simd_float.h. Loops
// without branches, because every other ray hits the mirror: the compiler makes vectors of them.

#include "lucerna/simd/simd_float.h"
#include "lucerna/trace/kernels/kernel.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

inline int64_t enter(const FrameView& k, const RayArrays& in, size_t n, double ray_flux, WorldRays& out,
                     bool& all_finite) {
  int64_t quanta = 0;
  int32_t odd = 0;
  for (size_t i = 0; i < n; ++i) {
    const float x = in.x[i], y = in.y[i], z = in.z[i], dx = in.dx[i], dy = in.dy[i], dz = in.dz[i];
    out.x[i] = k.m[0] * x + k.m[1] * y + k.m[2] * z + k.v[0];
    out.y[i] = k.m[3] * x + k.m[4] * y + k.m[5] * z + k.v[1];
    out.z[i] = k.m[6] * x + k.m[7] * y + k.m[8] * z + k.v[2];
    out.dx[i] = k.m[0] * dx + k.m[1] * dy + k.m[2] * dz;
    out.dy[i] = k.m[3] * dx + k.m[4] * dy + k.m[5] * dz;
    out.dz[i] = k.m[6] * dx + k.m[7] * dy + k.m[8] * dz;
    const float sum = x + y + z + dx + dy + dz;
    odd |= sum - sum == 0.0f ? 0 : 1;
    out.mirror[i] = -1;
    out.number[i] = static_cast<int32_t>(i);
  }
  for (size_t i = 0; i < n; ++i) {
    out.flux[i] = static_cast<float>(static_cast<double>(in.weight[i]) * ray_flux);
    quanta += quanta_of(out.flux[i]);
  }
  all_finite = odd == 0;
  return quanta;
}

inline MirrorSums resolve_hits(const LocalHits& hits, const int32_t* reflections, int32_t max,
                               const double* throughput, int32_t mirror, size_t n, float* flux,
                               int32_t* status) {
  MirrorSums sum{};
  for (size_t i = 0; i < n; ++i) {
    const int32_t front = hits.state[i] == kFront ? 1 : 0, back = hits.state[i] == kBack ? 1 : 0;
    const int32_t last = reflections[i] == max ? front : 0, goes_on = front - last;
    const float after = static_cast<float>(static_cast<double>(flux[i]) * throughput[i]);
    const int64_t quanta = quanta_of(flux[i]);
    flux[i] = goes_on != 0 ? after : flux[i];
    sum.face += quanta - quanta_of(flux[i]);
    sum.back += back != 0 ? quanta : 0;
    sum.lost += last != 0 ? quanta : 0;
    sum.lost_rays += last;
    sum.reflections += goes_on;
    const int32_t next = goes_on != 0 ? mirror : static_cast<int32_t>(kTerminated);
    status[i] = hits.state[i] == kMiss ? status[i] : next;
  }
  return sum;
}

/// The n statuses at `status`, in the first lanes: an array of them may end with the last.
inline Int load_status(const int32_t* status, size_t n) {
  if (n >= static_cast<size_t>(kLanes)) return load(status);
  alignas(64) int32_t lanes[kLanes];
  for (size_t i = 0; i < static_cast<size_t>(kLanes); ++i)
    lanes[i] = i < n ? status[i] : static_cast<int32_t>(kTerminated);
  return load(lanes);
}

inline size_t compact(WorldRays& rays, const int32_t* status, size_t n, WorldRays& out, size_t& out_count) {
  size_t stay = 0;
  for (size_t i = 0; i < n; i += static_cast<size_t>(kLanes)) {
    const size_t rest = n - i;
    const Mask lanes = mask_of(rest >= static_cast<size_t>(kLanes) ? (1u << kLanes) - 1u : (1u << rest) - 1u);
    const Int f = load_status(status + i, rest);
    const Mask leaves = lanes & (f == Int(kEscaped)), stays = lanes & ~(leaves | (f == Int(kTerminated)));
    // Whole vectors are written: what is behind the last lane is written over by the next, or padding.
    const auto move = [&](auto array) {
      const auto v = load(rays.*array + i);
      store(rays.*array + stay, compress(stays, v));
      store(out.*array + out_count, compress(leaves, v));
    };
    move(&WorldRays::x);
    move(&WorldRays::y);
    move(&WorldRays::z);
    move(&WorldRays::dx);
    move(&WorldRays::dy);
    move(&WorldRays::dz);
    move(&WorldRays::flux);
    move(&WorldRays::number);
    store(rays.mirror + stay, compress(stays, f));
    stay += static_cast<size_t>(__builtin_popcount(bits(stays)));
    out_count += static_cast<size_t>(__builtin_popcount(bits(leaves)));
  }
  return stay;
}

}  // namespace
}  // namespace lucerna
