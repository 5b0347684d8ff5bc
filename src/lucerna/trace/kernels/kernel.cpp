// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/kernel.h"

#include "lucerna/core/io/error.h"
#include "lucerna/simd/dispatch.h"

namespace lucerna {

namespace {

Dispatch<Kernels> trace_kernels() {
  Dispatch<Kernels> all{.scalar = scalar_kernels, .portable = portable_kernels};
#if defined(LUCERNA_X86_KERNELS)
  all.avx2 = avx2_kernels;
  all.avx512 = avx512_kernels;
#endif
  return all;
}

}  // namespace

const Kernels& best_kernels() { return trace_kernels().best(); }

const Kernels& kernels_named(const char* isa) {
  if (const Kernels* kernels = trace_kernels().named(isa)) return *kernels;
  throw UsageError(fmt::format("instruction set '{}' is not one that this build and processor have", isa));
}

}  // namespace lucerna
