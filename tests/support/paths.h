// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

/// Where this build's files are. Functions, so that only paths.cpp depends on the place and ccache can serve
/// the tests of one checkout to another.
namespace lucerna::test {

/// The repository.
std::filesystem::path source_dir();
/// The folder of real files, which need not exist (CMake's LUCERNA_DATA_DIR).
std::filesystem::path data_dir();
/// The program `lucerna` of this build.
std::filesystem::path program();
/// The folder of this build, that `cmake --install` takes.
std::filesystem::path build_dir();
/// The compiler of this build.
std::filesystem::path compiler();
/// The folder of the programs of examples/.
std::filesystem::path examples();

}  // namespace lucerna::test
