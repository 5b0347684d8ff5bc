// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include "lucerna/project.h"

namespace lucerna {

struct ProjectTables::Toml {
  toml::table table;
};

inline toml::table& toml_tables(Project& project) { return project.tables.toml().table; }
inline const toml::table& toml_tables(const Project& project) { return project.tables.toml().table; }

}  // namespace lucerna
