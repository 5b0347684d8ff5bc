// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/accelerator_error.h"

#include "lucerna/core/error.h"

namespace lucerna {

void throw_accelerator_error(const char* name, const char* what) {
  throw InputError(fmt::format("{}: {}", name, what));
}

}  // namespace lucerna
