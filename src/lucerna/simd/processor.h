// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Whether this processor runs code that is compiled for AVX2 or AVX-512 here: all that the options of
/// src/lucerna/CMakeLists.txt let a compiler use. False where the build has no such code. Thread safe.
bool has_avx2();
bool has_avx512();

}  // namespace lucerna
