// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <thread>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/distributed/ranks.h"
#include "lucerna/progress.h"

namespace lucerna {

/// Ranks as the peers of a design, with what a signal to one of them comes to. To be called from the thread
/// that made it.
class RankPeers final : public Peers {
 public:
  /// `own`: the progress of this rank. Both must outlive it.
  RankPeers(Ranks& ranks, Progress& own) : ranks_(ranks), progress_(own) {}

  int rank() const override { return ranks_.rank(); }
  int size() const override { return ranks_.size(); }
  std::vector<std::string> gather(const std::string& mine) override;
  std::vector<std::string> exchange(const std::vector<std::string>& to) override;

  /// Asks to stop on all ranks at the same moment of their common computation: from the first `gather` after
  /// any rank's own progress has asked for it.
  Progress& progress() { return progress_; }

 private:
  class AgreedProgress final : public Progress {
   public:
    explicit AgreedProgress(Progress& own) : own_(own) {}
    void update(std::string_view phase, std::uint64_t done, std::uint64_t total) override {
      own_.update(phase, done, total);
    }
    bool stop_requested() const override { return stop_; }
    bool own_stop_requested() const { return own_.stop_requested(); }
    void stop() { stop_ = true; }

   private:
    Progress& own_;
    bool stop_ = false;
  };

  void check_thread() const;

  Ranks& ranks_;
  AgreedProgress progress_;
  std::thread::id thread_ = std::this_thread::get_id();
};

}  // namespace lucerna
