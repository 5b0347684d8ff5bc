// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lucerna::cli {

/// A script for bash that completes commands, options, values of a few words and file names, from the
/// program's own options. Needs nothing but bash 4.
std::string bash_completion();

}  // namespace lucerna::cli
