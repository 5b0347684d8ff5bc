// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/reduction.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <tuple>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "lucerna/trace/tally/wide_sums.h"

namespace lucerna {

namespace {

std::span<std::int64_t> as_signed(std::vector<std::uint64_t>& numbers) {
  return {reinterpret_cast<std::int64_t*>(numbers.data()), numbers.size()};
}

void add_tally(Ranks& ranks, Tally& tally, bool two_lanes) {
  std::vector<std::uint64_t> counts{tally.rays, tally.reflections};
  counts.insert(counts.end(), tally.lost_rays.begin(), tally.lost_rays.end());
  ranks.add_to_first(as_signed(counts));
  tally.rays = counts[0];
  tally.reflections = counts[1];
  std::copy(counts.begin() + 2, counts.end(), tally.lost_rays.begin());
  if (two_lanes) split_lanes(tally);
  for_each_sum(tally, [&](std::int64_t* sums, std::size_t n) { ranks.add_to_first({sums, n}); });
  if (!two_lanes) return;
  ranks.add_to_first(tally.high);
  settle_lanes(tally);
}

/// The columns of a block of rays, in one fixed order.
auto columns(auto& rays) {
  return std::array{&rays.x_mm, &rays.y_mm, &rays.z_mm, &rays.kx, &rays.ky, &rays.kz, &rays.weight};
}

struct KeptRays {
  std::vector<OutRun> runs;
  RayBlock rays;
};

/// A run of kept rays and where its rays are.
struct Place {
  OutRun run;
  std::size_t part, first;
};

/// Blocks are traced whole by one rank, but for the one that a trace to go on with ends in: the first rank
/// has its first rays.
void join(const std::vector<KeptRays>& parts, TraceResult& sums) {
  std::vector<Place> places;
  std::size_t total = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::size_t first = 0;
    for (const OutRun& run : parts[p].runs) {
      places.push_back({run, p, first});
      first += run.rays;
    }
    total += first;
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tuple(a.run.block, a.run.source, a.part) < std::tuple(b.run.block, b.run.source, b.part);
  });
  sums.out_runs.clear();
  sums.out_rays = RayBlock();
  sums.out_rays.reserve(total);
  for (const Place& place : places) {
    for (std::uint32_t i = 0; i < place.run.rays; ++i)
      sums.out_rays.append(parts[place.part].rays, place.first + i);
    const bool same_run = !sums.out_runs.empty() && sums.out_runs.back().block == place.run.block &&
                          sums.out_runs.back().source == place.run.source;
    if (same_run) {
      sums.out_runs.back().rays += place.run.rays;
    } else {
      sums.out_runs.push_back(place.run);
    }
  }
}

}  // namespace

void add_sums_to_first(Ranks& ranks, TraceResult& sums, std::uint64_t rays) {
  for (Tally& tally : sums.replicates) add_tally(ranks, tally, rays > kMaxRaysOfOneLane);
}

void add_rays_to_first(Ranks& ranks, TraceResult& sums) {
  if (sums.ray_detectors.empty()) return;
  std::string mine;
  append(mine, sums.out_runs);
  for (const auto* column : columns(sums.out_rays)) append(mine, *column);
  const std::vector<std::string> all = ranks.gather(mine);
  if (!ranks.is_first()) return;
  std::vector<KeptRays> parts;
  for (std::string_view bytes : all) {
    KeptRays& part = parts.emplace_back();
    take(bytes, part.runs);
    for (auto* column : columns(part.rays)) take(bytes, *column);
  }
  join(parts, sums);
}

}  // namespace lucerna
