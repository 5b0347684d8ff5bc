// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lucerna/cli/parse/session.h"

namespace lucerna::cli {

/// Adds one command to the program. Its callback does the work when the command line names it; it may set
/// `exit_code` (to 1: a check failed, to 3: interrupted) and throws lucerna::Error otherwise.
using AddCommand = void (*)(CLI::App& app, Session& session, int& exit_code);

void add_init(CLI::App& app, Session& session, int& exit_code);
void add_info(CLI::App& app, Session& session, int& exit_code);
void add_check(CLI::App& app, Session& session, int& exit_code);
void add_convert(CLI::App& app, Session& session, int& exit_code);
void add_make_source(CLI::App& app, Session& session, int& exit_code);
void add_compress(CLI::App& app, Session& session, int& exit_code);
void add_sample(CLI::App& app, Session& session, int& exit_code);
void add_trace(CLI::App& app, Session& session, int& exit_code);
void add_merge(CLI::App& app, Session& session, int& exit_code);
void add_compare(CLI::App& app, Session& session, int& exit_code);
void add_design(CLI::App& app, Session& session, int& exit_code);
void add_report(CLI::App& app, Session& session, int& exit_code);
void add_bench(CLI::App& app, Session& session, int& exit_code);

/// In the order of `lucerna --help`.
inline constexpr std::array kCommands{add_init,     add_info,   add_check, add_convert, add_make_source,
                                      add_compress, add_sample, add_trace, add_merge,   add_compare,
                                      add_design,   add_report, add_bench};

}  // namespace lucerna::cli
