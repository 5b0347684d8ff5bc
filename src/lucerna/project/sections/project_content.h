// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include "lucerna/project.h"

namespace lucerna {

/// A project's tables with the SHA-256 of its content in place of each file's name, be it on disk or in
/// `memory`: the same for one project on two machines, another once a file has changed. Reads every file
/// once. Throws InputError where one cannot be read.
toml::table content_tables(toml::table tables, const ProjectMemory& memory);

}  // namespace lucerna
