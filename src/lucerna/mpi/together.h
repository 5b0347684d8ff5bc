// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/distributed/ranks.h"

namespace lucerna {

/// Does `work`, which is not collective, and tells all ranks what went wrong on one. Collective.
template <class Work>
void together(Ranks& ranks, const Work& work) {
  std::string error;
  try {
    work();
  } catch (const std::exception& e) {
    error = e.what();
  }
  agree(ranks, error);
}

/// Does `work`, whose errors of the kinds below all ranks have alike; any other ends the run of all, for the
/// rest may be waiting for this rank.
template <class Work>
void or_abort(Ranks& ranks, const Work& work) {
  try {
    work();
  } catch (const AgreedError&) {
    throw;
  } catch (const UsageError&) {
    throw;  // the same line on all ranks
  } catch (const Interrupted&) {
    throw;  // after all have agreed
  } catch (const std::exception& e) {
    fmt::print(stderr, "lucerna-mpi: rank {}: {}\n", ranks.rank(), e.what());
    ranks.abort(1);
  }
}

}  // namespace lucerna
