// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lucerna {

/// The reference page of project files, in Markdown: a section a table, a row a key, from `project_keys`.
std::string project_reference();

}  // namespace lucerna
