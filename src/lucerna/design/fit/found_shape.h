// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// What a search came to, and what it cost.
struct FoundShape {
  DesignShape shape;
  int evaluations = 0;
  std::uint64_t rays = 0;
};

}  // namespace lucerna
