// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lucerna/error.h"

namespace lucerna {

/// The processes of one run, as seen by one of them: the little of message passing that is needed here. All
/// functions but `rank`, `size`, `take_number`, `skip_numbers` and `poll` are collective: every rank calls
/// them, in the same order. Not thread safe but for `poll`, which one thread at a time may call.
class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  bool is_first() const { return rank() == 0; }

  /// The next of the numbers 0, 1, 2, ..., each of which one rank gets.
  virtual std::uint64_t take_number() = 0;
  /// From now on every rank gets numbers of 2^40 or more: the work is to end.
  virtual void skip_numbers() = 0;
  /// Lets the library move on while this rank computes.
  virtual void poll() = 0;

  /// The text of the first rank, on every rank.
  virtual std::string broadcast(const std::string& text) = 0;
  /// The texts of all ranks in order, at the first; nothing elsewhere.
  virtual std::vector<std::string> gather(const std::string& text) = 0;
  /// to[r] goes to rank r; returns what each rank has sent to this one, in order.
  virtual std::vector<std::string> exchange(const std::vector<std::string>& to) = 0;
  /// Adds the numbers of all ranks, at the first; elsewhere they are left.
  virtual void add_to_first(std::span<std::int64_t> numbers) = 0;

  /// Ends all ranks at once, for what one alone has met: the others may be waiting for it.
  [[noreturn]] virtual void abort(int exit_code) = 0;
};

/// The texts of all ranks in order, on every rank. Collective.
std::vector<std::string> gather_everywhere(Ranks& ranks, const std::string& text);

/// What went wrong on one rank, as all ranks throw it.
class AgreedError final : public InputError {
 public:
  explicit AgreedError(const std::string& what) : InputError(what, ErrorCause::mismatch) {}
};

/// Throws AgreedError on all ranks unless each has the text of the first, of which `what` says what it is.
/// Collective.
void agree_on_same(Ranks& ranks, const std::string& what, const std::string& mine);

/// Throws AgreedError on all ranks if one of them has an error to tell (not empty): the first of them.
/// Collective.
void agree(Ranks& ranks, const std::string& error);

}  // namespace lucerna
