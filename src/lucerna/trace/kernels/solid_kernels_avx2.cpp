// SPDX-License-Identifier: Apache-2.0
#include "lucerna/simd/simd_double.h"
#include "lucerna/trace/kernels/solid_kernels.h"
#include "lucerna/trace/kernels/solid_lanes.h"

namespace lucerna {

const SolidKernels& avx2_solid_kernels() {
  static constexpr SolidKernels kernels{"avx2", first_sides<SimdDouble>, side_normals<SimdDouble>,
                                        enter_solid<SimdDouble>, cross_boundaries<SimdDouble>};
  return kernels;
}

}  // namespace lucerna
