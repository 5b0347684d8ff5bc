// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/hit_kernels.h"

#include "lucerna/simd/dispatch.h"
#include "lucerna/simd/scalar_double.h"

namespace lucerna {

namespace {

Dispatch<HitKernels> all_hit_kernels() {
  Dispatch<HitKernels> all{.scalar = scalar_hit_kernels};
#if defined(LUCERNA_X86_KERNELS)
  all.avx2 = avx2_hit_kernels;
  all.avx512 = avx512_hit_kernels;
#endif
  return all;
}

}  // namespace

const HitKernels& scalar_hit_kernels() {
  static constexpr HitKernels kernels{"scalar", search_hits<ScalarDouble, BsplineHitTable>,
                                      search_hits<ScalarDouble, RevolutionHitTable>};
  return kernels;
}

const HitKernels* hit_kernels_named(const char* isa) { return all_hit_kernels().named(isa); }

const HitKernels& best_hit_kernels() {
  static const HitKernels& best = all_hit_kernels().best();  // asked for by every batch
  return best;
}

}  // namespace lucerna
