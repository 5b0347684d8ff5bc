// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/host_device.h"

namespace lucerna {

/// Adds to a whole number that other threads of a GPU add to as well; a plain addition on the CPU, where
/// threads have sums of their own.
LUCERNA_HD inline void atomic_add(std::int64_t* to, std::int64_t x) {
#if defined(__CUDA_ARCH__)
  atomicAdd(reinterpret_cast<unsigned long long*>(to), static_cast<unsigned long long>(x));
#else
  *to += x;
#endif
}

}  // namespace lucerna
