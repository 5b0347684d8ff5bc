// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/device/accelerator_error.h"

#include "lucerna/core/io/error.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

void throw_accelerator_error(const char* name, const char* what) {
  throw InputError(fmt::format("{}: {}", name, what), ErrorCause::unsupported);
}

void require_cuda() {
  if (const std::string why = cuda_unavailable_reason(); !why.empty())
    throw InputError("no CUDA device: " + why, ErrorCause::unsupported, "device");
}

}  // namespace lucerna
