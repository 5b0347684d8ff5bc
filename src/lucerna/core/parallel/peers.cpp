// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/parallel/peers.h"

#include <bit>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"

namespace lucerna {

double of_first(Peers* peers, double mine) {
  if (peers == nullptr) return mine;
  std::string bytes;
  append_double(bytes, mine);
  const std::vector<std::string> all = peers->gather(bytes);
  std::string_view first = all.front();
  return take_double(first);
}

bool of_first(Peers* peers, bool mine) { return of_first(peers, mine ? 1.0 : 0.0) != 0.0; }

StateKey& StateKey::add(std::uint64_t number) {
  for (int byte = 0; byte < 8; ++byte) hash_ = (hash_ ^ (number >> (8 * byte) & 0xFF)) * 0x100000001b3ull;
  return *this;
}

StateKey& StateKey::add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }

namespace detail {

std::vector<std::string> gather_keyed(Peers& peers, std::uint64_t key, const std::string& mine) {
  std::string bytes;
  append(bytes, key);
  bytes += mine;
  std::vector<std::string> all = peers.gather(bytes);
  for (std::size_t r = 1; r < all.size(); ++r) {
    if (std::string_view(all[r]).substr(0, sizeof key) == std::string_view(all[0]).substr(0, sizeof key))
      continue;
    throw InputError(
        fmt::format("process {} no longer has the numbers of process 0: are their processors alike?", r),
        ErrorCause::mismatch);
  }
  return all;
}

}  // namespace detail

}  // namespace lucerna
