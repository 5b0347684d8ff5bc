// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// A Monte Carlo figure: what leaves the library instead of a naked number.
struct Estimate {
  double mean = 0.0;
  /// Standard error of `mean`, same unit.
  double standard_error = 0.0;
};

}  // namespace lucerna
