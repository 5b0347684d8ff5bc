// SPDX-License-Identifier: Apache-2.0
// Any bytes as a checkpoint of a design: a state that is written and read back to the same text, or
// InputError. The key is always `fuzz`.
#include <string>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/design/search/checkpoint.h"

namespace {

template <class Parse>
void round_trip(const std::string& bytes, const Parse& parse) {
  try {
    const std::string text = checkpoint_text(parse(bytes, "fuzz"), "fuzz");
    require(checkpoint_text(parse(text, "fuzz"), "fuzz") == text);
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  round_trip(bytes, lucerna::parse_checkpoint);
  round_trip(bytes, lucerna::parse_search_checkpoint);
  try {
    require(lucerna::checkpoint_evaluations(bytes) >= 0);
  } catch (const lucerna::InputError&) {
    // The same.
  }
  return 0;
}
