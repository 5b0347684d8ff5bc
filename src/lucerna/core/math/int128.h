// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Whole numbers of 128 bits, which both compilers have beyond the standard: exact sums and products of
/// 64-bit ones.
__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

}  // namespace lucerna
