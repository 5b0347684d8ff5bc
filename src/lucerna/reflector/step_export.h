// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/reflector/reflector.h"

namespace lucerna {

/// A reflector as a STEP file (ISO 10303-21, application protocol 214), mm, in the mirror's own frame, as an
/// open shell whose normal looks towards the light. Free forms are one bicubic B-spline surface, the very
/// one that is traced, with x and y as its parameters; profiles are swept surfaces of revolution, of the very
/// spline where they are `RevolutionShape`s, else of a cubic that is within 1e-6 mm of the profile. Outlines
/// and holes are exact for revolution and along rectangles, else curves within 1e-6 mm of the surface. The
/// text depends on nothing but the reflector. Throws InputError for a surface that is neither, and names it.
std::string step_text(const Reflector& reflector, const std::string& name = "reflector");

}  // namespace lucerna
