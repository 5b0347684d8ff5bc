// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Throws the InputError "NAME: WHAT". Declared apart so that CUDA sources need no formatting library.
[[noreturn]] void throw_accelerator_error(const char* name, const char* what);

}  // namespace lucerna
