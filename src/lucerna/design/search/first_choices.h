// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lucerna/design/initial/transport_guess.h"

namespace lucerna {

/// The first candidates of a search for free forms, those before the approaches and those after them.
/// Distances are told in a mirror's radius, half a trough's width, a lens face's own distance from the
/// source.
struct FirstChoices {
  std::array<TransportChoice, 2> before;
  std::array<TransportChoice, 7> after;
};

/// Mirrors that spread light near the source, and mirrors whose rays cross farther from it. Others catch too
/// little light or become walls.
inline constexpr FirstChoices kMirrors{
    {{{-1.0, 0.33}, {-1.0, 0.27}}},
    {{{-1.0, 0.21}, {-1.0, 0.45}, {1.0, 0.75}, {1.0, 0.92}, {1.0, 0.33}, {1.0, 0.27}, {1.0, 0.45}}}};
/// The last face of a lens, at the given face's distance from the source and beside it. Faces whose rays
/// cross are good for narrow beams only.
inline constexpr FirstChoices kFaces{
    {{{-1.0, 1.0}, {-1.0, 1.25}}},
    {{{-1.0, 1.12}, {-1.0, 0.9}, {-1.0, 0.8}, {-1.0, 1.5}, {1.0, 1.0}, {-1.0, 0.65}, {1.0, 1.25}}}};
/// Troughs of both orders of rays.
inline constexpr FirstChoices kTroughs{
    {{{-1.0, 0.75}, {1.0, 1.0}}},
    {{{-1.0, 0.5}, {1.0, 0.75}, {-1.0, 0.4}, {-1.0, 0.33}, {-1.0, 0.25}, {-1.0, 0.18}, {-1.0, 1.0}}}};

/// Those of a kind of shape.
constexpr const FirstChoices& first_choices(bool is_face, bool is_trough) {
  return is_face ? kFaces : is_trough ? kTroughs : kMirrors;
}

}  // namespace lucerna
