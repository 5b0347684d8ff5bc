// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <barrier>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "lucerna/core/parallel/peers.h"

namespace lucerna::test {

/// What threads that play peers share.
struct PeerWorld {
  explicit PeerWorld(int n) : size(n), meet(n), letters(static_cast<std::size_t>(n)) {}
  int size;
  std::barrier<> meet;
  std::vector<std::vector<std::string>> letters;
};

/// Peers as threads of one process.
class LocalPeers final : public Peers {
 public:
  LocalPeers(PeerWorld& world, int rank) : world_(world), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return world_.size; }
  std::vector<std::string> gather(const std::string& mine) override {
    return exchange(std::vector<std::string>(static_cast<std::size_t>(world_.size), mine));
  }
  std::vector<std::string> exchange(const std::vector<std::string>& to) override {
    world_.meet.arrive_and_wait();
    world_.letters[static_cast<std::size_t>(rank_)] = to;
    world_.meet.arrive_and_wait();
    std::vector<std::string> from;
    for (const auto& letters : world_.letters) from.push_back(letters[static_cast<std::size_t>(rank_)]);
    return from;
  }

 private:
  PeerWorld& world_;
  int rank_;
};

/// Calls `body(peers)` on `n` peers at once; returns what each threw, empty where nothing. One that throws
/// leaves the others alone: what they exchange then is no longer whole.
inline std::vector<std::string> on_peers(int n, const std::function<void(Peers& peers)>& body) {
  PeerWorld world(n);
  std::vector<std::string> errors(static_cast<std::size_t>(n));
  std::vector<std::thread> threads;
  for (int r = 0; r < n; ++r) {
    threads.emplace_back([&, r] {
      LocalPeers peers(world, r);
      try {
        body(peers);
      } catch (const std::exception& e) {
        errors[static_cast<std::size_t>(r)] = e.what();
      }
      world.meet.arrive_and_drop();
    });
  }
  for (std::thread& t : threads) t.join();
  return errors;
}

}  // namespace lucerna::test
