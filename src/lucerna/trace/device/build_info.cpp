// SPDX-License-Identifier: Apache-2.0
#include "lucerna/build_info.h"

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/device/accelerator.h"
#include "lucerna/trace/kernels/kernel.h"
#include "lucerna/version.h"

namespace lucerna {

BuildInfo build_info() {
  BuildInfo info;
  info.version = version();
#if defined(__clang__)
  info.compiler = "clang " __clang_version__;
#else
  info.compiler = "g++ " __VERSION__;
#endif
  info.isa = best_kernels().isa;
  info.threads = ThreadLimit::current();
#if defined(LUCERNA_EMBREE)
  info.embree = true;
#endif
  info.cuda_unavailable = cuda_unavailable_reason();
  return info;
}

}  // namespace lucerna
