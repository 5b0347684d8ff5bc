// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <barrier>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "lucerna/distributed/ranks.h"

namespace lucerna::test {

/// What threads that play ranks share.
struct LocalWorld {
  explicit LocalWorld(int n)
      : size(n), meet(n), texts(static_cast<std::size_t>(n)), sums(texts.size()), letters(texts.size()) {}
  int size;
  std::barrier<> meet;
  std::vector<std::string> texts;
  std::vector<std::span<std::int64_t>> sums;
  std::vector<std::vector<std::string>> letters;
  std::atomic<std::uint64_t> next{0};
};

/// Ranks as threads of one process: the algorithm without MPI.
class LocalRanks final : public Ranks {
 public:
  LocalRanks(LocalWorld& world, int rank) : world_(world), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return world_.size; }
  std::uint64_t take_number() override { return world_.next.fetch_add(1); }
  void skip_numbers() override { world_.next.fetch_add(std::uint64_t{1} << 40); }
  void poll() override {}
  std::string broadcast(const std::string& text) override {
    world_.meet.arrive_and_wait();
    if (rank_ == 0) world_.texts[0] = text;
    world_.meet.arrive_and_wait();
    return world_.texts[0];
  }
  std::vector<std::string> gather(const std::string& text) override {
    world_.meet.arrive_and_wait();
    world_.texts[static_cast<std::size_t>(rank_)] = text;
    world_.meet.arrive_and_wait();
    return rank_ == 0 ? world_.texts : std::vector<std::string>();
  }
  void add_to_first(std::span<std::int64_t> numbers) override {
    world_.sums[static_cast<std::size_t>(rank_)] = numbers;
    world_.meet.arrive_and_wait();
    if (rank_ == 0) {
      for (std::size_t r = 1; r < world_.sums.size(); ++r) {
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += world_.sums[r][i];
      }
    }
    world_.meet.arrive_and_wait();
  }
  std::vector<std::string> exchange(const std::vector<std::string>& to) override {
    world_.meet.arrive_and_wait();
    world_.letters[static_cast<std::size_t>(rank_)] = to;
    world_.meet.arrive_and_wait();
    std::vector<std::string> from;
    for (const auto& letters : world_.letters) from.push_back(letters[static_cast<std::size_t>(rank_)]);
    return from;
  }
  [[noreturn]] void abort(int) override { std::abort(); }

 private:
  LocalWorld& world_;
  int rank_;
};

}  // namespace lucerna::test
