// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ray file: the reader either returns rays that keep its promise, or throws InputError. Built
// once for detection by content (ray_file) and once for each format (ray_FORMAT, LUCERNA_FUZZ_FORMAT), so
// that bytes need no magic to get past the door.
#include <cmath>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"

#if !defined(LUCERNA_FUZZ_FORMAT)
#define LUCERNA_FUZZ_FORMAT ""
#endif

namespace {

void read_all(const std::string& path, bool salvage) {
  try {
    const auto reader = lucerna::open_ray_file(path, {.salvage = salvage, .format = LUCERNA_FUZZ_FORMAT});
    lucerna::RayBlock block;
    std::uint64_t count = 0;
    while (const std::size_t n = reader->read(block, 4096)) {
      require(n == block.size() && block.extra.size() == reader->header().columns.size());
      for (std::size_t i = 0; i < n; ++i) {
        require(std::isfinite(block.x_mm[i]) && std::isfinite(block.y_mm[i]) && std::isfinite(block.z_mm[i]));
        require(std::abs(length(lucerna::Vec3{block.kx[i], block.ky[i], block.kz[i]}) - 1.0) < 2e-6);
        require(block.weight[i] >= 0.0F && std::isfinite(block.weight[i]));
      }
      count += n;
    }
    require(count <= reader->ray_count());
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  read_all(file.path(), false);
  read_all(file.path(), true);
  return 0;
}
