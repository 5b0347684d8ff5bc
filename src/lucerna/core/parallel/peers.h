// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

/// Processes that run one computation together, as seen by one of them. Each has all of its numbers and takes
/// all of its decisions, and does a part of its work; what the parts come to is put together in the order of
/// one process, so that all of them go on with its bits. All functions but `rank` and `size` are collective:
/// every process calls them, in the same order, from one thread.
class Peers {
 public:
  virtual ~Peers() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// What each process passes, in order, on all of them.
  virtual std::vector<std::string> gather(const std::string& mine) = 0;
  /// to[r] goes to process r; returns what each has sent to this one, in order.
  virtual std::vector<std::string> exchange(const std::vector<std::string>& to) = 0;
};

/// Items [first, last).
struct ItemRange {
  std::size_t first = 0, last = 0;
  std::size_t size() const { return last - first; }
};

/// Which of `n` items process `rank` of `size` has: a stretch, the stretches of all in order, alike long but
/// for one.
constexpr ItemRange items_of(int rank, int size, std::size_t n) {
  const auto r = static_cast<std::size_t>(rank), all = static_cast<std::size_t>(size);
  return {n * r / all, n * (r + 1) / all};
}

/// Those of this process; all of them without peers (null).
inline ItemRange own_items(const Peers* peers, std::size_t n) {
  return peers == nullptr ? ItemRange{0, n} : items_of(peers->rank(), peers->size(), n);
}

/// What process 0 passes, on all of them; without peers (null) what is passed. For clocks: one decides.
bool of_first(Peers* peers, bool mine);
double of_first(Peers* peers, double mine);

/// A hash of numbers that all processes are to have alike (FNV-1a of their bits).
class StateKey {
 public:
  StateKey& add(std::uint64_t number);
  StateKey& add(double number);
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

namespace detail {

/// Gathers messages that begin with `key`; throws InputError on all processes unless their keys are one.
std::vector<std::string> gather_keyed(Peers& peers, std::uint64_t key, const std::string& mine);

}  // namespace detail

/// Gives every process all of `n` items, of which each has its own (`own_items`): `write(i, bytes)` appends
/// an item to the bytes, `read(i, view)` takes it from their front. Without peers (null) nothing happens.
/// `key` is of what the items depend on: processes that no longer hold the same numbers, of unlike
/// processors for one, are found by it. Collective. Throws InputError on all processes if keys differ.
template <class Write, class Read>
void share_items(Peers* peers, std::size_t n, std::uint64_t key, const Write& write, const Read& read) {
  if (peers == nullptr) return;
  std::string mine;
  const ItemRange own = own_items(peers, n);
  for (std::size_t i = own.first; i < own.last; ++i) write(i, mine);
  const std::vector<std::string> all = detail::gather_keyed(*peers, key, mine);
  for (int r = 0; r < peers->size(); ++r) {
    if (r == peers->rank()) continue;
    std::string_view bytes = std::string_view(all[static_cast<std::size_t>(r)]).substr(sizeof key);
    const ItemRange theirs = items_of(r, peers->size(), n);
    for (std::size_t i = theirs.first; i < theirs.last; ++i) read(i, bytes);
  }
}

/// n items as texts, each made by one process alone and given to all; without peers (null) by this one.
/// `make(i)` is not collective; a process that has several of them calls it on several threads. Collective;
/// `key` as in share_items. Throws InputError on all processes if `make` does on one.
template <class Make>
std::vector<std::string> dealt_items(Peers* peers, std::size_t n, std::uint64_t key, const Make& make) {
  std::vector<std::string> items(n), errors(n);
  const ItemRange own = own_items(peers, n);
  parallel_blocks(own.size(), 1, [&](std::size_t first, std::size_t) {
    const std::size_t i = own.first + first;
    try {
      items[i] = make(i);
    } catch (const InputError& e) {
      errors[i] = e.what();
    }
  });
  share_items(
      peers, n, key,
      [&](std::size_t i, std::string& bytes) {
        append_text(bytes, items[i]);
        append_text(bytes, errors[i]);
      },
      [&](std::size_t i, std::string_view& bytes) {
        items[i] = take_text(bytes);
        errors[i] = take_text(bytes);
      });
  for (const std::string& error : errors) {
    if (!error.empty()) throw InputError(error);
  }
  return items;
}

/// Calls `body(i)` for each i < n: in any order on any thread, or where each of them shares its work with
/// peers one after the other, as what is collective has to be called.
template <class Body>
void for_each_shared(Peers* peers, std::size_t n, const Body& body) {
  if (peers == nullptr) {
    parallel_blocks(n, 1, [&](std::size_t i, std::size_t) { body(i); });
  } else {
    for (std::size_t i = 0; i < n; ++i) body(i);
  }
}

}  // namespace lucerna
