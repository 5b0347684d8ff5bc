// SPDX-License-Identifier: Apache-2.0
#define LUCERNA_SCALAR
#include "lucerna/trace/kernels/field_kernel.h"
#include "lucerna/trace/kernels/wavefront_kernel.h"

namespace lucerna {

const Kernels& scalar_kernels() {
  static constexpr Kernels kernels{"scalar", to_local,     intersect, reflect_rays,
                                   enter,    resolve_hits, compact,   far_field_cells};
  return kernels;
}

}  // namespace lucerna
