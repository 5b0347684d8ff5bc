// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/hit_kernels.h"

#include <string_view>

#include "lucerna/core/cpu/processor.h"
#include "lucerna/simd/scalar_double.h"

namespace lucerna {

const HitKernels& scalar_hit_kernels() {
  static constexpr HitKernels kernels{"scalar", search_hits<ScalarDouble, BsplineHitTable>,
                                      search_hits<ScalarDouble, RevolutionHitTable>};
  return kernels;
}

const HitKernels* hit_kernels_named(const char* isa) {
  const std::string_view name = isa;
  if (name == "scalar") return &scalar_hit_kernels();
#if defined(LUCERNA_X86_KERNELS)
  if (name == "avx2" && has_avx2()) return &avx2_hit_kernels();
  if (name == "avx512" && has_avx512()) return &avx512_hit_kernels();
#endif
  return nullptr;
}

const HitKernels& best_hit_kernels() {
  for (const char* isa : {"avx512", "avx2"}) {
    if (const HitKernels* kernels = hit_kernels_named(isa)) return *kernels;
  }
  return scalar_hit_kernels();
}

}  // namespace lucerna
