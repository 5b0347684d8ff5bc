// SPDX-License-Identifier: Apache-2.0
#include "lucerna/simd/simd_double.h"
#include "lucerna/trace/kernels/hit_kernels.h"

namespace lucerna {

const HitKernels& avx512_hit_kernels() {
  static constexpr HitKernels kernels{"avx512", search_hits<SimdDouble, BsplineHitTable>,
                                      search_hits<SimdDouble, RevolutionHitTable>};
  return kernels;
}

}  // namespace lucerna
