// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace lucerna::cli {

class Session;

/// Names the program and adds its commands. `session` and `exit_code` must outlive `app`.
void set_up(CLI::App& app, Session& session, int& exit_code);

/// Parses the line and does what it says. Returns `exit_code` where all is well, else as `run`; errors are
/// printed if `tell`.
int parse_and_run(CLI::App& app, int argc, char** argv, const int& exit_code, bool tell = true);

/// The whole program: parses, calls the library, prints. Returns the exit code: 0 done, 1 bad input or a
/// failed check, 2 usage, 3 interrupted.
int run(int argc, char** argv);

}  // namespace lucerna::cli
