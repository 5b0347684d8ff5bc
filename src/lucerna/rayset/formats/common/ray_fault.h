// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/rays.h"

namespace lucerna {

/// |k|^2 may differ from 1 by this much: more, and the three numbers are no direction.
inline constexpr double kDirectionTolerance = 2e-3;

/// The first ray of a block that breaks the promise of RayReader::read: what was found and expected.
struct RayFault {
  std::size_t index = 0;
  std::string what;
};

/// Normalises the directions of rays [first, last) whose length is off by more than float32 rounding and
/// returns the first faulty ray of that range, if any: a start, direction or weight that is not finite, a
/// direction whose length is not 1 to 1e-3, a negative weight, or an extra column other than Stokes and
/// additional that is not finite. About 1 ns per ray. Thread safe for disjoint ranges.
std::optional<RayFault> check_rays(RayBlock& block, const std::vector<ColumnSpec>& columns, std::size_t first,
                                   std::size_t last);

/// Takes every faulty ray out of `block`, keeping the order of the rest; returns how many went and sets
/// `example` to the first one's fault. For salvaging what is whole.
std::size_t drop_faulty_rays(RayBlock& block, const std::vector<ColumnSpec>& columns, RayFault& example);

}  // namespace lucerna
