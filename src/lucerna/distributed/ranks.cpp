// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/ranks.h"

#include <cstring>

#include "lucerna/core/io/error.h"

namespace lucerna {

std::vector<std::string> gather_everywhere(Ranks& ranks, const std::string& text) {
  std::string packed;
  for (const std::string& each : ranks.gather(text)) {
    const std::uint64_t size = each.size();
    packed.append(reinterpret_cast<const char*>(&size), sizeof size);
    packed += each;
  }
  packed = ranks.broadcast(packed);
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < packed.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, packed.data() + at, sizeof size);
    texts.push_back(packed.substr(at + sizeof size, size));
    at += sizeof size + size;
  }
  return texts;
}

void agree_on_same(Ranks& ranks, const std::string& what, const std::string& mine) {
  const std::string first = ranks.broadcast(mine);
  agree(ranks, mine == first ? "" : fmt::format("has the {} {}, rank 0 has {}", what, mine, first));
}

void agree(Ranks& ranks, const std::string& error) {
  const std::vector<std::string> errors = gather_everywhere(ranks, error);
  for (std::size_t r = 0; r < errors.size(); ++r) {
    if (errors[r].empty()) continue;
    throw AgreedError(r == 0 ? errors[r] : fmt::format("rank {}: {}", r, errors[r]));
  }
}

}  // namespace lucerna
