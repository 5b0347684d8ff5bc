// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/host_device.h"

namespace lucerna {

/// All sums of a trace are whole numbers of one unit, so that they do not depend on the order of adding: one
/// unit is 2^-26 of the mean ray's flux. Rounding is at most 2^-27 of a mean ray per deposit, far below
/// counting noise. No sum can overflow: beyond 2^62 units a tally has two lanes a sum (wide_sums.h). Rays are
/// numbered up to 2^53, so that every program that reads their numbers as doubles has them exactly.
inline constexpr double kQuantaPerRay = 0x1p26;
inline constexpr std::uint64_t kMaxRays = std::uint64_t{1} << 53;
/// Rays that sums of one lane hold for certain, as those on a device are: 2^60 units, of 2^63.
inline constexpr std::uint64_t kMaxRaysOfOneLane = std::uint64_t{1} << 34;

/// A ray's flux >= 0, in mean rays, as whole quanta. Static: kernels of each instruction set have their own
/// copy.
LUCERNA_HD static inline std::int64_t quanta_of(float flux) {
  return static_cast<std::int64_t>(static_cast<double>(flux) * kQuantaPerRay + 0.5);
}

/// Rays per block: the unit that is drawn, traced and given to one replicate.
inline constexpr std::uint64_t kBlockRays = 512;
/// Independent replicates of every run, for standard errors.
inline constexpr std::uint64_t kReplicates = 16;

}  // namespace lucerna
