// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/field_kernel.h"
#include "lucerna/trace/kernels/wavefront_kernel.h"

namespace lucerna {

const Kernels& avx512_kernels() {
  static constexpr Kernels kernels{"avx512", to_local,     intersect, reflect_rays,
                                   enter,    resolve_hits, compact,   far_field_cells};
  return kernels;
}

}  // namespace lucerna
