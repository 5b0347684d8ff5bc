// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

#include "lucerna/source.h"
#include "lucerna/trace.h"

/// What GoogleTest prints as the parameter of a test, instead of its bytes. It looks for this name.
namespace lucerna {

// NOLINTBEGIN(readability-identifier-naming)
inline void PrintTo(EmitterKind kind, std::ostream* out) { *out << to_string(kind); }
inline void PrintTo(EngineKind kind, std::ostream* out) {
  *out << (kind == EngineKind::fast ? "fast" : "reference");
}
// NOLINTEND(readability-identifier-naming)

}  // namespace lucerna
