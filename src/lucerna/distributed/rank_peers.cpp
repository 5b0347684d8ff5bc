// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/rank_peers.h"

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// The last byte of every message.
constexpr char kGoesOn = '0', kWantsToStop = '1';

}  // namespace

void RankPeers::check_thread() const {
  LUCERNA_CHECK(std::this_thread::get_id() == thread_, "rank {} exchanges numbers on a second thread",
                rank());
}

std::vector<std::string> RankPeers::gather(const std::string& mine) {
  check_thread();
  std::vector<std::string> all =
      gather_everywhere(ranks_, mine + (progress_.own_stop_requested() ? kWantsToStop : kGoesOn));
  for (std::string& text : all) {
    LUCERNA_CHECK(!text.empty(), "a message without an end");
    if (text.back() == kWantsToStop) progress_.stop();
    text.pop_back();
  }
  return all;
}

std::vector<std::string> RankPeers::exchange(const std::vector<std::string>& to) {
  check_thread();
  return ranks_.exchange(to);
}

}  // namespace lucerna
