// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/rank_peers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>

#include "tests/support/local_ranks.h"

namespace lucerna {
namespace {

void on_local_ranks(int n, const std::function<void(Ranks& ranks)>& body) {
  test::LocalWorld world(n);
  std::vector<std::thread> threads;
  for (int r = 0; r < n; ++r) {
    threads.emplace_back([&, r] {
      test::LocalRanks ranks(world, r);
      body(ranks);
    });
  }
  for (std::thread& t : threads) t.join();
}

class Wish final : public Progress {
 public:
  void update(std::string_view, std::uint64_t, std::uint64_t) override {}
  bool stop_requested() const override { return stop; }
  std::atomic<bool> stop = false;
};

TEST(RankPeers, PassTextsOfAnyBytes) {
  on_local_ranks(3, [](Ranks& ranks) {
    Wish own;
    RankPeers peers(ranks, own);
    const std::string mine(static_cast<std::size_t>(ranks.rank()), '\0');
    EXPECT_EQ(peers.gather(mine), (std::vector<std::string>{"", std::string(1, '\0'), std::string(2, '\0')}));
    std::vector<std::string> to;
    for (int r = 0; r < 3; ++r) to.push_back(std::to_string(10 * ranks.rank() + r));
    const std::vector<std::string> from = peers.exchange(to);
    for (int r = 0; r < 3; ++r)
      EXPECT_EQ(from[static_cast<std::size_t>(r)], std::to_string(10 * r + ranks.rank()));
    EXPECT_FALSE(peers.progress().stop_requested());
  });
}

// A signal reaches one rank between two gatherings: all see it after the next, none before.
TEST(RankPeers, StopAtTheSameMoment) {
  std::atomic<int> early = 0, stopped = 0;
  on_local_ranks(3, [&](Ranks& ranks) {
    Wish own;
    RankPeers peers(ranks, own);
    peers.gather("");
    own.stop = ranks.rank() == 1;
    peers.exchange({"", "", ""});
    early += peers.progress().stop_requested() ? 1 : 0;
    peers.gather("");
    stopped += peers.progress().stop_requested() ? 1 : 0;
  });
  EXPECT_EQ(early, 0);
  EXPECT_EQ(stopped, 3);
}

TEST(RankPeers, RefuseAnotherThread) {
  on_local_ranks(1, [](Ranks& ranks) {
    Wish own;
    RankPeers peers(ranks, own);
    std::string error;
    std::thread([&] {
      try {
        peers.gather("");
      } catch (const std::logic_error& e) {
        error = e.what();
      }
    }).join();
    EXPECT_THAT(error, testing::HasSubstr("second thread"));
  });
}

}  // namespace
}  // namespace lucerna
