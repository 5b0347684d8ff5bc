// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {

SequenceKind sequence_kind(std::string_view name) {
  if (name == "random") return SequenceKind::random;
  if (name == "sobol") return SequenceKind::sobol;
  throw UsageError(fmt::format("unknown sequence '{}'; expected random or sobol", name));
}

std::string_view to_string(SequenceKind kind) { return kind == SequenceKind::random ? "random" : "sobol"; }

}  // namespace lucerna
