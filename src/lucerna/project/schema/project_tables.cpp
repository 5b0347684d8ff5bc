// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/project_tables.h"

#include <utility>

namespace lucerna {

ProjectTables::ProjectTables() : toml_(std::make_unique<Toml>()) {}
ProjectTables::~ProjectTables() = default;
ProjectTables::ProjectTables(const ProjectTables& other) : toml_(std::make_unique<Toml>(*other.toml_)) {}
// What was moved from is empty but whole.
ProjectTables::ProjectTables(ProjectTables&& other) noexcept : toml_(std::make_unique<Toml>()) {
  std::swap(toml_, other.toml_);
}
ProjectTables& ProjectTables::operator=(const ProjectTables& other) {
  *toml_ = *other.toml_;
  return *this;
}
ProjectTables& ProjectTables::operator=(ProjectTables&& other) noexcept {
  std::swap(toml_, other.toml_);
  return *this;
}

}  // namespace lucerna
