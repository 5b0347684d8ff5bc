// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the small functions that CPU and GPU share: `LUCERNA_HD inline ...` is a plain inline function under
/// g++ and clang, and `__host__ __device__` under nvcc. Code so marked uses no exceptions, allocation or
/// globals.
#if defined(__CUDACC__)
#define LUCERNA_HD __host__ __device__
#else
#define LUCERNA_HD
#endif

/// After LUCERNA_HD: a GPU calls this function instead of copying it into its callers, whose registers stay
/// free for what they do most.
#if defined(__CUDACC__)
#define LUCERNA_HD_CALL __noinline__
#else
#define LUCERNA_HD_CALL
#endif
