// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/thinned_ray_set.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/merge_ray_sets.h"
#include "lucerna/rayset/data/subset.h"

namespace lucerna {

namespace {

RaySet thinned(RayReader& reader, std::uint64_t wanted, std::uint64_t seed, Progress& progress) {
  const RaySubset subset(reader.ray_count(), wanted, seed);
  RaySet set{reader.header(), {}};
  std::uint64_t first = 0;
  for_each_block(reader, progress, "read rays", [&](const RayBlock& block) {
    subset.select(block, first, set.rays);
    first += block.size();
  });
  return set;
}

}  // namespace

ThinnedRaySet thinned_ray_set(const std::vector<std::filesystem::path>& files, std::uint64_t max_rays,
                              std::uint64_t seed, Progress& progress) {
  std::vector<std::unique_ptr<RayReader>> readers;
  ThinnedRaySet out;
  for (const std::filesystem::path& file : files) {
    readers.push_back(open_ray_file(file));
    out.of += readers.back()->ray_count();
  }
  const double part = out.of > max_rays ? static_cast<double>(max_rays) / static_cast<double>(out.of) : 1.0;
  for (std::size_t k = 0; k < files.size(); ++k) {
    const std::uint64_t count = readers[k]->ray_count(), one = count > 0 ? 1 : 0;
    // A file without a ray would lose its flux.
    const std::uint64_t wanted = std::max(one, static_cast<std::uint64_t>(part * static_cast<double>(count)));
    RaySet set = thinned(*readers[k], wanted, seed, progress);
    if (files.size() == 1) {
      out.set = std::move(set);
    } else {
      merge_ray_sets(out.set, std::move(set), files[k].string());
    }
  }
  return out;
}

}  // namespace lucerna
