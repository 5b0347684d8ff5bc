// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "lucerna/rays.h"

namespace lucerna {

/// Calls its argument with all rays of a source, block by block. Where wavelengths differ from ray to ray,
/// they are the only extra column.
using RayStream = std::function<void(const std::function<void(const RayBlock&)>&)>;

}  // namespace lucerna
