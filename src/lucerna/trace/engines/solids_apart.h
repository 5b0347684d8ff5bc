// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/scene.h"

namespace lucerna {

/// Throws InputError where light within a clear body would not meet what it should, naming both: where it
/// holds, cuts or touches (within 5 um) another one or a cover glass, or holds or cuts a body or a mirror;
/// where shells of one mesh cut each other, or are turned so that one is not outside or a hollow of another;
/// and where two cover glasses share room. Some microseconds a triangle of what is near to each other.
void check_apart(const Scene& scene);

/// A line for each mirror and body that reaches into a cover glass. Light crosses a plate in one step, so it
/// passes what is within. Mirrors of a swept curve are not looked at, nor what reaches in by less than 1 um.
/// Some microseconds a triangle of what is near to a plate.
std::vector<std::string> within_plates(const Scene& scene);

}  // namespace lucerna
