// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lucerna/simd/processor.h"

namespace lucerna {

/// One table of functions, compiled for several instruction sets; null where this build has none. Choosing is
/// thread safe.
template <class Table>
struct Dispatch {
  /// What returns a table is compiled for its instruction set too, so it is only called where that runs.
  using Get = const Table& (*)();
  /// One lane; vectors that any processor has; AVX2 and AVX-512.
  Get scalar = nullptr, portable = nullptr, avx2 = nullptr, avx512 = nullptr;

  /// "scalar", "portable", "avx2" or "avx512"; null for any other name, and where this build or processor has
  /// it not.
  const Table* named(std::string_view isa) const {
    Get get = nullptr;
    if (isa == "scalar") get = scalar;
    if (isa == "portable") get = portable;
    if (isa == "avx2" && has_avx2()) get = avx2;
    if (isa == "avx512" && has_avx512()) get = avx512;
    return get != nullptr ? &get() : nullptr;
  }

  /// The widest that this processor runs. One of the first two must be there.
  const Table& best() const {
    for (const std::string_view isa : {"avx512", "avx2", "portable"}) {
      if (const Table* table = named(isa)) return *table;
    }
    return scalar();
  }
};

}  // namespace lucerna
