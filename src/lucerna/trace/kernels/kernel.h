// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace lucerna {

// What the tracing kernels share with the rest: plain data only, so that a kernel compiled for one
// instruction set (or for a GPU) brings no other code along.

/// Rays of a batch; arrays are padded to a whole number of vectors.
inline constexpr size_t kBatch = 512;
/// Room behind a batch for the rest of a vector that is written whole.
inline constexpr size_t kBatchEnd = 16;

/// A HeightField as a kernel reads it.
struct FieldView {
  const float* vertices;  ///< 3 floats each, (cells + 1)^2
  const float* nodes;     ///< 4 floats each
  int32_t offsets[16];    ///< first node of each level
  int32_t levels;         ///< of nodes
  int32_t blocks;         ///< leaf squares a side, of 8 x 8 cells
  float x0, y0, x1, y1;   ///< region
  float step_x, step_y;
  float q0, qx, qy, qxx, qxy, qyy;  ///< quadric
  float reach;                      ///< the quadric stays within this of q0 over the region
  float low, high;                  ///< band of heights over the quadric
  float rim;                        ///< cells of a round mirror end within this distance of the axis
  float gradient_bound;             ///< no gradient over the quadric is longer, as far as the rim
  float tolerance;                  ///< rounding of a height over the quadric
  bool round;                       ///< aperture: a circle of half_x, or a rectangle
  float half_x, half_y, hole;       ///< half sizes and the hole's radius
};

/// Rays in a mirror's frame.
struct LocalRays {
  alignas(64) float x[kBatch], y[kBatch], z[kBatch];
  alignas(64) float dx[kBatch], dy[kBatch], dz[kBatch];
  /// 1 for a ray that was just reflected by this mirror: it starts on its front.
  alignas(64) int32_t on_mirror[kBatch];
};

enum : int32_t { kMiss = 0, kFront = 1, kBack = 2 };

/// Where they meet it.
struct LocalHits {
  alignas(64) float t[kBatch];
  /// t in two parts: the way to where the mirror's box begins, and from there. The place is o + start d,
  /// rounded,
  /// + past d; o + t d is off by what t rounds.
  alignas(64) float start[kBatch], past[kBatch];
  /// A normal there of any length, towards the front: (-gx, -gy, gz). A height field's is its gradient and 1.
  alignas(64) float gx[kBatch], gy[kBatch], gz[kBatch];
  alignas(64) int32_t state[kBatch];  ///< kMiss, kFront, kBack
};

/// Rays in the luminaire frame, with what they carry.
struct WorldRays {
  static constexpr size_t kSize = kBatch + kBatchEnd;
  alignas(64) float x[kSize], y[kSize], z[kSize];
  alignas(64) float dx[kSize], dy[kSize], dz[kSize];
  /// In mean rays.
  alignas(64) float flux[kSize];
  /// Mirror that the ray was last reflected by, below 0 if none.
  alignas(64) int32_t mirror[kSize];
  /// Number within the batch as it was emitted.
  alignas(64) int32_t number[kSize];
};

/// Rays as a source gives them, in its frame.
struct RayArrays {
  const float *x, *y, *z, *dx, *dy, *dz, *weight;
};

/// What becomes of a ray: the number of the mirror that reflects it, or one of these.
enum : int32_t { kEscaped = -1, kTerminated = -2, kHitObstacle = -3 };

/// What one mirror does to the rays of a batch, in quanta (flux_quanta.h) and in numbers of rays.
struct MirrorSums {
  int64_t face, back;  ///< absorbed by its reflectance, and by its back
  int64_t lost;        ///< of rays that would be reflected once too often
  int64_t lost_rays, reflections;
};

/// A rotation by rows and a translation, in float: out = m p + v.
struct FrameView {
  float m[9];
  float v[3];
};

/// The kernels of one instruction set.
struct Kernels {
  const char* isa;
  /// Rays into a mirror's frame; `index` is the mirror's number.
  void (*to_local)(const FrameView& local_from_world, const WorldRays& in, size_t n, int32_t index,
                   LocalRays& out);
  /// First hits of n rays with a height field.
  void (*intersect)(const FieldView& field, const LocalRays& rays, size_t n, LocalHits& hits);
  /// Reflected rays, in the luminaire frame, for lanes whose hit is kFront; also the cosine of incidence.
  void (*reflect)(const FrameView& world_from_local, const LocalRays& rays, const LocalHits& hits, size_t n,
                  WorldRays& out, float* cosine);
  /// Rays of a source, numbered and in the luminaire frame, n <= kBatch; `ray_flux` is what a weight of 1
  /// carries, in mean rays. Returns their flux in quanta; `all_finite` says whether all numbers are.
  int64_t (*enter)(const FrameView& world_from_source, const RayArrays& in, size_t n, double ray_flux,
                   WorldRays& out, bool& all_finite);
  /// Takes off what mirror `mirror` absorbs of the rays that it meets and notes their statuses, which stay as
  /// they are where it hits none. Ray i was reflected reflections[i] times, `max` is all that it may be; a
  /// front reflects kept[i] of it.
  MirrorSums (*resolve_hits)(const LocalHits& hits, const int32_t* reflections, int32_t max,
                             const double* throughput, int32_t mirror, size_t n, float* flux,
                             int32_t* status);
  /// Moves the rays that leave behind the `out_count` of `out`, drops those that are gone, and closes the
  /// gaps; returns how many stay. Reads n statuses and no more; whole vectors of the rays.
  size_t (*compact)(WorldRays& rays, const int32_t* status, size_t n, WorldRays& out, size_t& out_count);
  /// Type C cell of each direction, as FarFieldGrid::cell has it.
  void (*far_field_cells)(const WorldRays& rays, size_t n, int32_t c_count, int32_t gamma_count,
                          int32_t* cell);
};

const Kernels& portable_kernels();
/// One ray at a time: what a GPU compiles, for the tests.
const Kernels& scalar_kernels();
#if defined(LUCERNA_X86_KERNELS)
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();
#endif

/// The best that this processor can run.
const Kernels& best_kernels();
/// "scalar", "portable", "avx2" or "avx512"; throws UsageError if unknown, or if this processor or build has
/// it not.
const Kernels& kernels_named(const char* isa);

}  // namespace lucerna
