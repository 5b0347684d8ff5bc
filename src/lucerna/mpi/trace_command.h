// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/cli/parse/session.h"
#include "lucerna/distributed/ranks.h"

namespace lucerna::cli {

/// Adds `lucerna-mpi trace`. `ranks` must outlive `app`.
void add_mpi_trace(CLI::App& app, Session& session, Ranks& ranks);

}  // namespace lucerna::cli
