// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// How bad something found in a file is.
enum class Severity {
  note,     ///< legal, but changes how the numbers are to be read
  warning,  ///< a rule is broken, and the reader went on as the text says; or the file may mean something
            ///< else
  error,    ///< cannot be used as it is
};

/// "note", "warning" or "error".
std::string_view to_string(Severity severity);

/// Something found in a file.
struct Diagnostic {
  /// How bad it is.
  Severity severity = Severity::warning;
  /// "line 3", "byte 20", "ray 17 (byte 37468)"; empty for the file as a whole.
  std::string place{};
  /// What is wrong, in words.
  std::string text{};
  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

/// "line 3: what is wrong", or the text alone where there is no place.
std::string to_string(const Diagnostic& diagnostic);

}  // namespace lucerna
#pragma GCC visibility pop
