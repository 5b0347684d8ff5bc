// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/cli/parse/session.h"
#include "lucerna/distributed/ranks.h"

namespace lucerna::cli {

/// Adds `lucerna-mpi design`, which sets `exit_code` on all ranks. `ranks` must outlive `app`.
void add_mpi_design(CLI::App& app, Session& session, Ranks& ranks, int& exit_code);

}  // namespace lucerna::cli
