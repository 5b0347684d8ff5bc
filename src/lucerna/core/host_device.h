// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the small functions that CPU and GPU share: `LUCERNA_HD inline ...` is a plain inline function under
/// g++ and clang, and `__host__ __device__` under nvcc. Code so marked uses no exceptions, allocation or globals.
#if defined(__CUDACC__)
#define LUCERNA_HD __host__ __device__
#else
#define LUCERNA_HD
#endif
