// SPDX-License-Identifier: Apache-2.0
#pragma once

/// LUCERNA_VECTOR_CLONES before a function compiles it for several instruction sets, of which the best is
/// taken when the program starts. Only for code whose results do not depend on the width of vectors:
/// additions, multiplications, divisions and roots are rounded one by one (no contraction, no reordering), so
/// every clone gives the same bits. What is called in it must be inlined: LUCERNA_ALWAYS_INLINE.
#if defined(__has_attribute) && defined(__x86_64__) && defined(__linux__)
#if __has_attribute(target_clones) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if defined(__has_feature)
#if !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer)
#define LUCERNA_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#else
#define LUCERNA_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
#endif
#endif
#ifndef LUCERNA_VECTOR_CLONES
#define LUCERNA_VECTOR_CLONES
#endif

#define LUCERNA_ALWAYS_INLINE __attribute__((always_inline))
