// SPDX-License-Identifier: Apache-2.0
// A race on purpose: blocks of one loop add to one sum. Under the thread sanitizer ctest asks that it is
// reported; a preset that misses it would miss ours.
#include <cstdio>

#include "lucerna/core/parallel/parallel.h"

int main() {
  std::size_t sum = 0;
  lucerna::parallel_blocks(1000, 10, [&sum](std::size_t first, std::size_t last) { sum += last - first; });
  std::printf("%zu\n", sum);
  return 0;
}
