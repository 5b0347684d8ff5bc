// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/parallel/peers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>

#include "lucerna/core/io/message_bytes.h"
#include "tests/support/local_peers.h"

namespace lucerna {
namespace {

TEST(Peers, EveryItemHasOneOwnerInTheOrderOfRanks) {
  for (const int size : {1, 2, 3, 5, 16, 40}) {
    for (const std::size_t n : {0u, 1u, 2u, 16u, 1000u}) {
      std::size_t next = 0;
      for (int r = 0; r < size; ++r) {
        const ItemRange own = items_of(r, size, n);
        EXPECT_EQ(own.first, next);
        EXPECT_LE(own.size(), n / static_cast<std::size_t>(size) + 1);
        next = own.last;
      }
      EXPECT_EQ(next, n);
    }
  }
}

TEST(Peers, ShareItemsSoThatAllHaveAll) {
  for (const int size : {1, 2, 3, 7}) {
    std::atomic<int> whole = 0;
    const auto errors = test::on_peers(size, [&](Peers& peers) {
      std::vector<double> items(5, -1.0);
      const ItemRange own = own_items(&peers, items.size());
      for (std::size_t i = own.first; i < own.last; ++i) items[i] = 0.1 * static_cast<double>(i);
      share_items(
          &peers, items.size(), 7, [&](std::size_t i, std::string& b) { append_double(b, items[i]); },
          [&](std::size_t i, std::string_view& b) { items[i] = take_double(b); });
      bool all = true;
      for (std::size_t i = 0; i < items.size(); ++i) all = all && items[i] == 0.1 * static_cast<double>(i);
      if (all) ++whole;
    });
    EXPECT_EQ(whole, size);
    for (const std::string& e : errors) EXPECT_EQ(e, "");
  }
}

TEST(Peers, TheFirstDecides) {
  std::atomic<int> right = 0;
  test::on_peers(3, [&](Peers& peers) {
    const bool first = peers.rank() == 0;
    if (of_first(&peers, first ? 0.1 : std::numeric_limits<double>::quiet_NaN()) == 0.1) ++right;
    if (of_first(&peers, first)) ++right;
    if (!of_first(&peers, !first)) ++right;
  });
  EXPECT_EQ(right, 9);
  EXPECT_TRUE(of_first(nullptr, true));
  EXPECT_EQ(of_first(nullptr, 2.5), 2.5);
}

TEST(Peers, WhoHasOtherNumbersIsFoundByAll) {
  const auto errors = test::on_peers(3, [&](Peers& peers) {
    const std::uint64_t key =
        peers.rank() == 2 ? StateKey().add(0.1 + 0.2).value() : StateKey().add(0.3).value();
    share_items(
        &peers, 0, key, [](std::size_t, std::string&) {}, [](std::size_t, std::string_view&) {});
  });
  for (const std::string& e : errors)
    EXPECT_THAT(e, testing::HasSubstr("process 2 no longer has the numbers"));
}

TEST(Peers, DealtItemsAreEachMadeOnceAndKnownToAll) {
  for (const std::size_t n : {0, 1, 2, 7}) {
    std::atomic<int> made = 0, whole = 0;
    const auto errors = test::on_peers(3, [&](Peers& peers) {
      const std::vector<std::string> items = dealt_items(&peers, n, 5, [&](std::size_t i) {
        ++made;
        return std::string(i, 'x');
      });
      bool all = items.size() == n;
      for (std::size_t i = 0; i < items.size(); ++i) all = all && items[i] == std::string(i, 'x');
      whole += all ? 1 : 0;
    });
    for (const std::string& e : errors) EXPECT_EQ(e, "");
    EXPECT_EQ(made, static_cast<int>(n));
    EXPECT_EQ(whole, 3);
  }
  const std::vector<std::string> alone{"0", "1"};
  EXPECT_EQ(dealt_items(nullptr, 2, 5, [](std::size_t i) { return std::to_string(i); }), alone);
}

TEST(Peers, AFaultOfOneDealtItemIsThatOfAll) {
  const auto errors = test::on_peers(3, [&](Peers& peers) {
    dealt_items(&peers, 6, 5, [](std::size_t i) -> std::string {
      if (i == 4) throw InputError("the fifth is bad");
      return "good";
    });
  });
  for (const std::string& e : errors) EXPECT_EQ(e, "the fifth is bad");
}

TEST(Peers, CollectiveBodiesAreCalledInTurn) {
  test::on_peers(2, [&](Peers& peers) {
    std::vector<std::size_t> order;
    for_each_shared(&peers, 9, [&](std::size_t i) { order.push_back(i); });
    EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  });
  std::atomic<int> calls = 0;
  for_each_shared(nullptr, 9, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 9);
}

}  // namespace
}  // namespace lucerna
