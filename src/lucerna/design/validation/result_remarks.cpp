// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/result_remarks.h"

#include <fmt/format.h>

namespace lucerna {

std::optional<std::string> noise_remark(const DesignError& error) {
  const BoxErrorEstimate& e = error.c48;
  if (!(e.excess <= 2.0 * e.standard_error)) return std::nullopt;
  return fmt::format("no error is left that {:.3g} M rays can distinguish from noise: {:.2f} +- {:.2f} %",
                     1e-6 * static_cast<double>(error.rays), 100.0 * e.excess, 100.0 * e.standard_error);
}

std::optional<std::string> no_step_remark(const DesignFindings& result) {
  if (result.evaluations > 0 || result.end == DesignTermination::converged) return std::nullopt;
  return "nothing was designed: the search ended before its first step, and the result is what it began with";
}

}  // namespace lucerna
