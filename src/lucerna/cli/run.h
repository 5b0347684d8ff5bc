// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna::cli {

/// The whole program: parses, calls the library, prints. Returns the exit code: 0 done, 1 bad input or a
/// failed check, 2 usage, 3 interrupted.
int run(int argc, char** argv);

}  // namespace lucerna::cli
