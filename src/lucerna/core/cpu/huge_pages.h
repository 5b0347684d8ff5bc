// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace lucerna {

/// Asks for large pages of memory for an array that is read all over, where with small ones most reads would
/// also walk the page table; before it is first written. Only advice: nothing changes where there are none,
/// or for arrays below 4 MiB. Thread safe.
void advise_huge_pages(void* data, std::size_t bytes);

}  // namespace lucerna
