// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/kernels/kernel.h"

namespace lucerna::test {

/// The kernels of every instruction set that this program has and this processor runs.
inline std::vector<const Kernels*> available_kernels() {
  std::vector<const Kernels*> all;
  for (const char* isa : {"scalar", "portable", "avx2", "avx512"}) {
    try {
      all.push_back(&kernels_named(isa));
    } catch (const UsageError&) {
    }
  }
  return all;
}

}  // namespace lucerna::test
