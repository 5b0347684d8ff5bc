// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "lucerna/cli/parse/session.h"
#include "lucerna/distributed/ranks.h"

namespace lucerna::cli {

/// `lucerna-mpi compress`: the model of `lucerna compress`, to the byte, of files that the ranks read
/// together.
void add_mpi_compress(CLI::App& app, Session& session, Ranks& ranks);

}  // namespace lucerna::cli
