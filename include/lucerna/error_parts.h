// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/error.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// What the text of an error is made of, for programs. What the text does not say is empty.
struct ErrorParts {
  /// The file, as it was given; "line 3", "byte 20", "ray 17 (byte 37468)", a key of a project file, or line
  /// and key.
  std::string path{}, place{};
  /// What was found and what was expected there: the clauses of the text.
  std::string found{}, expected{};
};

/// Takes the text apart by the form that all texts have: "FILE: PLACE: ..., found X, expected Y" or
/// "FILE: PLACE: X, expected Y" (docs/reference/errors.md). O(text).
[[nodiscard]] ErrorParts error_parts(const Error& error);

}  // namespace lucerna
#pragma GCC visibility pop
