// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/emitters/draw_rays.h"

#include <algorithm>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Rays per task: large enough to keep threads busy, small enough to share out one streaming block.
constexpr std::size_t kTaskRays = 4096;

/// Fills all of `out` with rays from `first` on; an extra column gets their wavelengths.
void fill(const RaySource& source, const Sequence& sequence, std::uint64_t first, RayBlock& out) {
  parallel_blocks(out.size(), kTaskRays, [&](std::size_t begin, std::size_t end) {
    RayBlock part;
    part.resize(end - begin, 0);
    source.emit(sequence, first + begin, part);
    const auto put = [&](const std::vector<float>& from, std::vector<float>& to) {
      std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    put(part.x_mm, out.x_mm);
    put(part.y_mm, out.y_mm);
    put(part.z_mm, out.z_mm);
    put(part.kx, out.kx);
    put(part.ky, out.ky);
    put(part.kz, out.kz);
    put(part.weight, out.weight);
    if (out.extra.empty()) return;
    source.emit_wavelengths(sequence, first + begin, std::span(out.extra[0]).subspan(begin, end - begin));
  });
}

}  // namespace

std::vector<std::string> draw_rays(const RaySource& source, const Sequence& sequence, std::uint64_t n,
                                   RayWriter& writer, Progress& progress) {
  const auto flux_per_ray =
      static_cast<float>(source.flux() / static_cast<double>(std::max<std::uint64_t>(n, 1)));
  RayBlock block;
  for (std::uint64_t done = 0; done < n;) {
    block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kStreamBlock, n - done)),
                 source.has_wavelengths() ? 1 : 0);
    fill(source, sequence, done, block);
    for (float& weight : block.weight) weight *= flux_per_ray;
    writer.write(block);
    done += block.size();
    progress.step("rays", done, n);
  }
  writer.finish();
  return writer.warnings();
}

RayBlock draw_rays(const RaySource& source, const Sequence& sequence, std::size_t n) {
  RayBlock all;
  all.resize(n, 0);
  fill(source, sequence, 0, all);
  return all;
}

}  // namespace lucerna
