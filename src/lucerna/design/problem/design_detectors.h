// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "lucerna/design/problem/target.h"
#include "lucerna/project.h"
#include "lucerna/project/schema/toml_reader.h"

namespace lucerna {

/// Name of the detector that a plane target is watched by.
inline constexpr const char* kTargetPlane = "target";

/// Refuses (InputError) a detector whose files would take the place of those that a design writes. `root`: of
/// the whole project; `shape`: what the files of the optic are named by.
void check_detector_names(TomlReader& root, std::string_view shape);

/// Adds what every design watches, also when its project is read again, where the project does not have it: a
/// far field, and the plane of a plane target. In the scene and in the project's tables. Throws InputError
/// where the project's own plane of that name is another one.
void add_design_detectors(Project& project, const DesignTarget& target);

}  // namespace lucerna
