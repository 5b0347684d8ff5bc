// SPDX-License-Identifier: Apache-2.0
// Any bytes as a catalogue of glasses (AGF): each glass has an index and an absorption that is not negative
// wherever it says so, or InputError.
#include <cmath>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/glass_catalogue.h"

namespace {

constexpr std::size_t kFewGlasses = 8;

template <class Use>
void or_input_error(const Use& use) {
  try {
    use();
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
}

void use_glass(const lucerna::CatalogueGlass& glass) {
  require(!glass.name.empty());
  for (const double nm : {glass.min_nm, 0.5 * (glass.min_nm + glass.max_nm), glass.max_nm, 587.56}) {
    or_input_error([&] {
      const double n = lucerna::glass_index(glass, nm);
      require(n > 0.0 && std::isfinite(n));
    });
    or_input_error([&] {
      const double absorption = lucerna::glass_absorption_per_mm(glass, nm);
      require(absorption >= 0.0 && std::isfinite(absorption));
    });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  or_input_error([&] {
    const auto names = lucerna::glass_names(file.path());
    for (std::size_t i = 0; i < names.size() && i < kFewGlasses; ++i)
      or_input_error([&] { use_glass(lucerna::read_glass(file.path(), names[i])); });
  });
  return 0;
}
