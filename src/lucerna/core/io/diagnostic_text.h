// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "lucerna/diagnostic.h"
#include "lucerna/error.h"

namespace lucerna {

/// Takes a place at the front of a message, "ray 17 (byte 9): what", into Diagnostic::place.
Diagnostic diagnostic(Severity severity, std::string message);

/// What a reader threw for a file, without the file's name before it.
Diagnostic diagnostic(const InputError& error, const std::filesystem::path& path);

/// "line 7", or nothing for line 0: the file as a whole.
std::string line_place(std::size_t line);
/// The line of such a place; 0 for any other.
std::size_t line_of(const Diagnostic& diagnostic);

}  // namespace lucerna
