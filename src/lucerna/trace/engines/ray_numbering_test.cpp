// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_numbering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

/// A source that only has a size.
class SizedSource final : public RaySource {
 public:
  SizedSource(double flux, std::optional<std::uint64_t> rays) : flux_(flux), rays_(rays) {}
  double flux() const override { return flux_; }
  FluxUnit flux_unit() const override { return FluxUnit::lumen; }
  std::optional<std::uint64_t> ray_count() const override { return rays_; }
  void emit(const Sequence&, std::uint64_t, RayBlock&) const override {}

 private:
  double flux_;
  std::optional<std::uint64_t> rays_;
};

PlacedSource sized(double flux, std::optional<std::uint64_t> rays = std::nullopt) {
  return {std::make_shared<SizedSource>(flux, rays), {}, std::nullopt};
}

TEST(SourceInterleaving, EveryPrefixIsBalancedAndTheWholeIsExact) {
  for (const std::vector<std::uint64_t>& shares : {std::vector<std::uint64_t>{7},
                                                   {3, 5},
                                                   {1, 1, 1},
                                                   {100, 3, 1, 40, 17},
                                                   std::vector<std::uint64_t>(31, 9)}) {
    const SourceInterleaving word(shares);
    const double bound = 1.0 + std::log2(static_cast<double>(shares.size()));
    std::vector<std::uint64_t> before(shares.size(), 0);
    for (std::uint64_t n = 0; n <= 3 * word.total(); ++n) {
      std::uint64_t sum = 0;
      for (std::size_t s = 0; s < shares.size(); ++s) {
        const std::uint64_t c = word.count(s, n);
        EXPECT_TRUE(c == before[s] || c == before[s] + 1);
        const double ideal =
            static_cast<double>(n) * static_cast<double>(shares[s]) / static_cast<double>(word.total());
        EXPECT_LE(std::abs(static_cast<double>(c) - ideal), bound);
        if (n == word.total()) {
          EXPECT_EQ(c, shares[s]);
        }
        before[s] = c;
        sum += c;
      }
      EXPECT_EQ(sum, n);
    }
  }
}

TEST(RayNumbering, EveryRayOfTheFilesComesOnce) {
  const std::vector<PlacedSource> sources{sized(10.0, 30011), sized(20.0, 777), sized(5.0, 12345)};
  const RayNumbering numbering(sources, 4);
  ASSERT_EQ(numbering.default_count(), 30011u + 777u + 12345u);
  std::vector<std::set<std::uint64_t>> seen(3), seeds(3);
  for (std::uint64_t i = 0; i < numbering.default_count(); i += kBlockRays) {
    for (const SourceRun& run : numbering.runs(i, std::min(i + kBlockRays, numbering.default_count()))) {
      for (std::uint64_t k = 0; k < run.count; ++k)
        EXPECT_TRUE(seen[run.source].insert(run.first + k).second);
      seeds[run.source].insert(run.sequence_seed);
    }
  }
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(seen[s].size(), numbering.word().share(s));
    EXPECT_EQ(*seen[s].rbegin(), numbering.word().share(s) - 1);
    EXPECT_EQ(seeds[s].size(), 1u);
  }
}

TEST(RayNumbering, SampledStreamsNeverRepeatAndHaveASeedPerReplicate) {
  const std::vector<PlacedSource> sources{sized(10.0), sized(1.0), sized(3.0), sized(2.0, 5000)};
  const RayNumbering numbering(sources, 4);
  std::map<std::pair<std::size_t, std::uint64_t>, std::set<std::uint64_t>> seen;
  for (std::uint64_t i = 0; i < 400 * kBlockRays; i += kBlockRays) {
    for (const SourceRun& run : numbering.runs(i, i + kBlockRays)) {
      auto& indices = seen[{run.source, run.sequence_seed}];
      for (std::uint64_t k = 0; k < run.count; ++k) EXPECT_TRUE(indices.insert(run.first + k).second);
    }
  }
  EXPECT_EQ(seen.size(), 3u * kReplicates + 1u);
}

TEST(RayNumbering, OneSampledSourceUsesItsStreamWithoutGaps) {
  const RayNumbering numbering({sized(10.0)}, 4);
  EXPECT_EQ(numbering.default_count(), std::uint64_t{1} << 20);
  const auto runs = numbering.runs(35 * kBlockRays + 5, 35 * kBlockRays + 9);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].first, 2 * kBlockRays + 5);
  EXPECT_EQ(runs[0].count, 4u);
}

TEST(RayNumbering, BlocksCutAnywhereGiveTheSameRays) {
  const RayNumbering numbering({sized(10.0), sized(7.0), sized(2.0, 999)}, 1);
  for (std::uint64_t block = 0; block < 40; ++block) {
    const std::uint64_t a = block * kBlockRays, m = a + 7 * block + 1, b = a + kBlockRays;
    std::map<std::size_t, std::pair<std::uint64_t, std::uint64_t>> whole, pieces;
    for (const SourceRun& r : numbering.runs(a, b)) whole[r.source] = {r.first, r.count};
    for (const auto& [from, to] : {std::pair{a, m}, std::pair{m, b}}) {
      for (const SourceRun& r : numbering.runs(from, to)) {
        auto& p = pieces[r.source];
        if (p.second == 0) p.first = r.first;
        EXPECT_EQ(p.first + p.second, r.first);
        p.second += r.count;
      }
    }
    EXPECT_EQ(whole, pieces);
  }
}

}  // namespace
}  // namespace lucerna
