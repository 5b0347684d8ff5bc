// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ray file: every reader either returns rays that keep its promise, or throws InputError.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "lucerna/core/error.h"
#include "lucerna/rayset/ray_file.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void read_all(const std::string& path, bool salvage) {
  try {
    const auto reader = lucerna::open_ray_file(path, {.salvage = salvage});
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
  const int file = ::memfd_create("rays", 0);
  if (file < 0) return 0;
  require(::write(file, data, size) == static_cast<ssize_t>(size));
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  read_all(path, false);
  read_all(path, true);
  ::close(file);
  return 0;
}
