// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/lens/lens_fit.h"

namespace lucerna {

/// Shapes the free face of a lens as a free form (LensProblem::free_face): the search of free-form
/// mirrors (free_form_search.h), with a face that refracts. Where the entry is free, too, cavities are
/// compared first (cavity_search.h). Decisions depend on counts alone.
LensFitResult fit_free_face(const LensProblem& problem, const LensFitOptions& options,
                            const LensFitWatcher& watch);

}  // namespace lucerna
