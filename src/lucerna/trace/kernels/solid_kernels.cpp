// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/solid_kernels.h"

#include "lucerna/simd/dispatch.h"
#include "lucerna/simd/scalar_double.h"
#include "lucerna/trace/kernels/solid_lanes.h"

namespace lucerna {

namespace {

Dispatch<SolidKernels> all_solid_kernels() {
  Dispatch<SolidKernels> all{.scalar = scalar_solid_kernels};
#if defined(LUCERNA_X86_KERNELS)
  all.avx2 = avx2_solid_kernels;
  all.avx512 = avx512_solid_kernels;
#endif
  return all;
}

}  // namespace

const SolidKernels& scalar_solid_kernels() {
  static constexpr SolidKernels kernels{"scalar", first_sides<ScalarDouble>, side_normals<ScalarDouble>,
                                        enter_solid<ScalarDouble>, cross_boundaries<ScalarDouble>};
  return kernels;
}

const SolidKernels* solid_kernels_named(const char* isa) { return all_solid_kernels().named(isa); }

const SolidKernels& best_solid_kernels() {
  static const SolidKernels& best = all_solid_kernels().best();  // asked for by every batch
  return best;
}

}  // namespace lucerna
