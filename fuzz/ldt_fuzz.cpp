// SPDX-License-Identifier: Apache-2.0
// libFuzzer entry: any bytes either read as a sound grid or are refused with InputError; nothing else may
// happen.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto file = lucerna::read_ldt({reinterpret_cast<const char*>(data), size}, "fuzz");
    if (!lucerna::grid_fault(file.distribution).empty()) std::abort();
  } catch (const lucerna::InputError&) {
  }
  return 0;
}
