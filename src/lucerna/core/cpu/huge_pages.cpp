// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/cpu/huge_pages.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace lucerna {

void advise_huge_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__)
  constexpr std::uintptr_t kPage = 4096;
  constexpr std::size_t kWorthIt = std::size_t{4} << 20;
  if (bytes < kWorthIt) return;
  const std::size_t before_page = -reinterpret_cast<std::uintptr_t>(data) % kPage;
  // Small pages serve where there are no huge ones.
  static_cast<void>(madvise(static_cast<char*>(data) + before_page, bytes - before_page, MADV_HUGEPAGE));
#endif
}

}  // namespace lucerna
