// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/trace/kernels/first_hit.h"

namespace lucerna {

/// The searches of first_hit.h compiled for one instruction set. All give the same bits.
struct HitKernels {
  const char* isa;
  /// Of the first n <= kHitBatch rays. Thread safe.
  void (*bspline)(const HitMirror<BsplineHitTable>&, const HitRays&, size_t n, HitEnds&);
  void (*revolution)(const HitMirror<RevolutionHitTable>&, const HitRays&, size_t n, HitEnds&);
};

/// The fastest that this processor has.
const HitKernels& best_hit_kernels();
/// "scalar", "avx2" or "avx512"; null where this build or processor lacks it.
const HitKernels* hit_kernels_named(const char* isa);

const HitKernels& scalar_hit_kernels();
#if defined(LUCERNA_X86_KERNELS)
const HitKernels& avx2_hit_kernels();
const HitKernels& avx512_hit_kernels();
#endif

}  // namespace lucerna
