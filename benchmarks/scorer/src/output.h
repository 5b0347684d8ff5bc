// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace bench {

/// Writes a file whole or not at all: under a temporary name beside it, then renamed. Throws InputError where
/// the place cannot be written; nothing is left behind then, and a file that was there stays as it was.
void write_whole(const std::string& file, const std::string& text);

}  // namespace bench
