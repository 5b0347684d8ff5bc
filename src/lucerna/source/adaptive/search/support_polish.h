// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/progress.h"
#include "lucerna/source/adaptive/search/support_score.h"

namespace lucerna {

/// Places a support as exactly as the rays say. Trees cut where they happen to, so that the likelihood of a
/// support is rough at steps below a hundredth of the source (some 0.003 nats); a parabola through scores at
/// four steps of each move, as wide as it takes for the score to fall well below that roughness, looks
/// through it. Steps are `length_mm` and `angle` at first. A vertex is taken if it is worth 4 nats of all
/// held-out rays. Cost: some 10 scores a move.
SupportScore polish_support(const HeldOutScorer& scorer, const Support& start, double length_mm, double angle,
                            Progress& progress);

}  // namespace lucerna
