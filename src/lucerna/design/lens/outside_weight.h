// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/problem/target.h"

namespace lucerna {

/// What squared differences of light beside the target's rectangle count in the fit of a lens's face, of
/// those within it: 1 for a target that fades out towards its edges, 0.04 for one that is even up to them,
/// and between these by how bright the edges are. A source that is wide beside the lens blurs edges: with
/// even light up to them some of it falls beside. If that counted as much, the light within would be uneven
/// instead; if it did not count at all, light could be piled up there. Some tenths of a second. Throws
/// InputError as box_target.
double outside_weight(const DesignTarget& target);

}  // namespace lucerna
