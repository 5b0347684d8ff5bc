// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/named_warnings.h"

#include <fmt/format.h>

namespace lucerna {

void add_named_warnings(const std::filesystem::path& file, const std::vector<std::string>& found,
                        std::vector<std::string>& warnings) {
  for (const std::string& warning : found) warnings.push_back(fmt::format("{}: {}", file.string(), warning));
}

}  // namespace lucerna
