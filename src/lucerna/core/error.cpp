// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/error.h"

namespace lucerna::detail {

void check_failed(const char* condition, const char* file, int line, const std::string& values) {
  throw std::logic_error(
      fmt::format("internal check failed: {} ({}) at {}:{}", condition, values, file, line));
}

}  // namespace lucerna::detail
