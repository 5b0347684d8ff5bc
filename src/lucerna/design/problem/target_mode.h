// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// How light counts against a target.
enum class TargetMode {
  shape,     ///< only the distribution: the result is scaled to fit best
  absolute,  ///< as it is
};

}  // namespace lucerna
