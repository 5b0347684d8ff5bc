// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/host_device.h"

namespace lucerna {

/// Sizes of neighbourhoods that bounds on a smooth shape's bend are known for, in cells of knots on each
/// side. A header of its own: kernels that bring no other code along read it.
inline constexpr int kNearSizes = 2;
LUCERNA_HD constexpr int near_cells(int size) { return size == 0 ? 1 : 3; }

}  // namespace lucerna
