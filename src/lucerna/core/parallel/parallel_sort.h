// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(LUCERNA_PLAIN_THREADS)
#include <algorithm>
#else
#include <oneapi/tbb/parallel_sort.h>
#endif

namespace lucerna {

/// Sorts by a strict weak order, by several threads. Items that compare equal end up in any order: `less`
/// should leave none that differ. With plain threads (core/parallel/parallel.h) it is one thread's sort.
template <class Iterator, class Less>
void parallel_sort(Iterator first, Iterator last, const Less& less) {
#if defined(LUCERNA_PLAIN_THREADS)
  std::sort(first, last, less);
#else
  oneapi::tbb::parallel_sort(first, last, less);
#endif
}

}  // namespace lucerna
