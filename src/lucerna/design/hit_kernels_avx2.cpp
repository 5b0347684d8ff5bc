// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/hit_kernels.h"
#include "lucerna/design/wide.h"

namespace lucerna {

const HitKernels& avx2_hit_kernels() {
  static constexpr HitKernels kernels{"avx2", search_hits<Wide, BsplineHitTable>,
                                      search_hits<Wide, RevolutionHitTable>};
  return kernels;
}

}  // namespace lucerna
