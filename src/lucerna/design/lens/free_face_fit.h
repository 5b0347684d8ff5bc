// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/lens/lens_fit.h"

namespace lucerna {

/// Shapes the free face of a lens as a free form (LensProblem::free_face): the search of free-form
/// mirrors (free_form_search.h), with a face that refracts. Its light is what goes straight through: light
/// that faces reflect on the way, and what meets the wall, counts as lost. Decisions depend on counts alone.
LensFitResult fit_free_face(const LensProblem& problem, const LensFitOptions& options,
                            const LensFitWatcher& watch);

}  // namespace lucerna
