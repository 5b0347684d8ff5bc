// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "lucerna/trace/kernels/revolved_view.h"

namespace lucerna {

// What the kernels of clear bodies share with the rest: plain data only, as in kernel.h. They do for many
// rays, in double, what solid_kernel.h and revolved_kernel.h do for one, with the same bits.

/// Rays of a batch, small enough for a processor's nearest cache; a whole number of vectors of any
/// instruction set.
inline constexpr size_t kSolidBatch = 128;

/// Light at the surfaces of a body, in the body's frame; see PolarisedRay and BoundaryHit.
struct SolidBatch {
  alignas(64) double ox[kSolidBatch], oy[kSolidBatch], oz[kSolidBatch];
  alignas(64) double dx[kSolidBatch], dy[kSolidBatch], dz[kSolidBatch];
  /// Of the electric field.
  alignas(64) double fx[kSolidBatch], fy[kSolidBatch], fz[kSolidBatch];
  /// How far away the surface is, which part of it, and where there. Before it is looked for: no further than
  /// `t`.
  alignas(64) double t[kSolidBatch], u[kSolidBatch], v[kSolidBatch];
  alignas(64) int32_t part[kSolidBatch];
  /// The outward normal there, of any length, and the smooth one, of any length and side, 0 for none.
  alignas(64) double nx[kSolidBatch], ny[kSolidBatch], nz[kSolidBatch];
  alignas(64) double sx[kSolidBatch], sy[kSolidBatch], sz[kSolidBatch];
  /// 1 for light within the body, else 0; the index beyond the boundary over that before it; and a uniform
  /// number that decides what becomes of it there.
  alignas(64) double inside[kSolidBatch], ratio[kSolidBatch], chance[kSolidBatch];
  /// 1 where light was reflected, and where nothing became of it: rounding had the surface behind it.
  alignas(64) double reflected[kSolidBatch], behind[kSolidBatch];
  /// The normal that counted, unit, towards where the light came from.
  alignas(64) double hx[kSolidBatch], hy[kSolidBatch], hz[kSolidBatch];
};

/// The kernels of one instruction set. All give the same bits. Thread safe. n <= kSolidBatch.
struct SolidKernels {
  const char* isa;
  /// As first_side has it, in (t_min, batch.t): `part`, `t` and `u`.
  void (*first_sides)(const RevolvedBlocks& blocks, double t_min, size_t n, SolidBatch& batch);
  /// Normals where rays meet sides.
  void (*side_normals)(const RevolvedSide* sides, size_t n, SolidBatch& batch);
  /// Makes light that meets a body there, `inside` or not: with a field, one of two by `chance`, as any_field
  /// does.
  void (*enter)(size_t n, SolidBatch& batch);
  /// Sends light on from boundaries, as boundary_hit and cross_boundary do.
  void (*cross_boundaries)(size_t n, SolidBatch& batch);
};

/// The fastest that this processor has.
const SolidKernels& best_solid_kernels();
/// "scalar", "avx2" or "avx512"; null where this build or processor lacks it.
const SolidKernels* solid_kernels_named(const char* isa);

const SolidKernels& scalar_solid_kernels();
#if defined(LUCERNA_X86_KERNELS)
const SolidKernels& avx2_solid_kernels();
const SolidKernels& avx512_solid_kernels();
#endif

}  // namespace lucerna
