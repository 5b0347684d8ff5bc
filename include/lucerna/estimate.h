// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// A Monte Carlo figure: what leaves the library instead of a naked number.
struct Estimate {
  /// The best value.
  double mean = 0.0;
  /// Standard error of `mean`, same unit; NaN where it is not known.
  double standard_error = 0.0;
};

/// The mean of independent values of one distribution, with its standard error: NaN for fewer than two.
/// `values` is not empty.
[[nodiscard]] Estimate mean_estimate(std::span<const double> values);

/// Standard errors to either side that make the 95 % interval of an estimate: Student's t for the 15 degrees
/// of freedom that 16 replicates leave.
inline constexpr double kIntervalErrors = 2.131;

/// "1759 +- 4": the error to one significant digit (two where the first is 1), the value to the same place.
/// An error that is not known leaves the value to five significant digits, one of zero (or of rounding, 1e-12
/// of the value) the same. `unit` is
/// appended after a blank unless it is empty.
std::string estimate_text(const Estimate& estimate, std::string_view unit = {});

/// The same of a share in percent: 0.8341 with an error of 0.0012 is "83.41 +- 0.12 %".
std::string share_text(const Estimate& share);

}  // namespace lucerna
#pragma GCC visibility pop
