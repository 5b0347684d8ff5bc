// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/kernel.h"

#include <string_view>

#include "lucerna/core/cpu/processor.h"
#include "lucerna/core/io/error.h"

namespace lucerna {

const Kernels& best_kernels() {
#if defined(LUCERNA_X86_KERNELS)
  if (has_avx512()) return avx512_kernels();
  if (has_avx2()) return avx2_kernels();
#endif
  return portable_kernels();
}

const Kernels& kernels_named(const char* isa) {
  const std::string_view name = isa;
  if (name == "scalar") return scalar_kernels();
  if (name == "portable") return portable_kernels();
#if defined(LUCERNA_X86_KERNELS)
  if (name == "avx2" && has_avx2()) return avx2_kernels();
  if (name == "avx512" && has_avx512()) return avx512_kernels();
#endif
  throw UsageError(fmt::format("instruction set '{}' is not one that this build and processor have", name));
}

}  // namespace lucerna
