// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace lucerna::cli {

class Session;

/// Names the program and adds its commands. `session` and `exit_code` must outlive `app`.
void set_up(CLI::App& app, Session& session, int& exit_code);

/// The whole program: parses, calls the library, prints. Returns the exit code: 0 done, 1 bad input or a
/// failed check, 2 usage, 3 interrupted.
int run(int argc, char** argv);

}  // namespace lucerna::cli
