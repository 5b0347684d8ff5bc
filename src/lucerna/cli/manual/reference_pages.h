// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace lucerna::cli {

/// The pages of docs/reference that the code writes: name of the file, text.
std::map<std::string, std::string> reference_pages();

}  // namespace lucerna::cli
