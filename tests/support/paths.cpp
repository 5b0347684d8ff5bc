// SPDX-License-Identifier: Apache-2.0
#include "tests/support/paths.h"

namespace lucerna::test {

std::filesystem::path source_dir() { return LUCERNA_SOURCE_DIR; }

std::filesystem::path data_dir() { return LUCERNA_DATA_DIR; }

std::filesystem::path program() { return LUCERNA_PROGRAM; }

std::filesystem::path build_dir() { return LUCERNA_BUILD_DIR; }

std::filesystem::path compiler() { return LUCERNA_COMPILER; }

std::filesystem::path examples() { return build_dir() / "examples"; }

}  // namespace lucerna::test
