// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lucerna/distributed/ranks.h"

namespace lucerna {

/// The processes that mpirun or srun has started. One a program: its constructor starts MPI, its destructor
/// ends it, which waits for the other ranks.
class MpiRanks final : public Ranks {
 public:
  MpiRanks(int& argc, char**& argv);
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::uint64_t take_number() override { return counter_before_adding(1); }
  void skip_numbers() override;
  void poll() override;
  std::string broadcast(const std::string& text) override;
  std::vector<std::string> gather(const std::string& text) override;
  std::vector<std::string> exchange(const std::vector<std::string>& to) override;
  void add_to_first(std::span<std::int64_t> numbers) override;
  [[noreturn]] void abort(int exit_code) override;

 private:
  /// The types of MPI stay out of headers.
  struct Window;
  std::uint64_t counter_before_adding(std::int64_t step);

  int rank_ = 0, size_ = 1;
  bool may_poll_ = false;
  std::unique_ptr<Window> window_;
};

}  // namespace lucerna
