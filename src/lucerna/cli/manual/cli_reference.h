// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lucerna::cli {

/// The reference page of the command line, in Markdown: a section a command, a row an option, from the
/// parser.
std::string cli_reference();

}  // namespace lucerna::cli
