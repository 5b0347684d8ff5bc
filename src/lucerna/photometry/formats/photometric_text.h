// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/core/io/diagnostic_text.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/text.h"
#include "lucerna/photometric_file.h"

namespace lucerna {

/// Decimals that give the largest value `peak` the wanted number of significant digits, between 0 and 9.
int decimals_for(double peak, int digits);

/// A number as photometric files want it: no exponent, no trailing zeros, '.' for the decimals; `decimals` <
/// 0 gives the shortest text that reads back to the same double.
std::string number_text(double value, int decimals);

/// `text` on one line: control characters become blanks, blanks at the ends go.
std::string one_line(std::string_view text);

/// Throws InputError for gamma angles that do not begin at 0 or 90 and end at 90 or 180: readers take what
/// lies between for light or for dark as they please. `format` is for the message.
void check_vertical_angles(const IntensityDistribution& distribution, std::string_view format);

/// Collects what a reader repairs, and refuses instead when strict.
class RepairLog {
 public:
  /// `name` is what errors call the file.
  RepairLog(std::string name, bool strict) : name_(std::move(name)), strict_(strict) {}

  /// One repair at `line` (from 1; 0 = whole file). Throws InputError if strict.
  template <class... Args>
  void repair(std::size_t line, fmt::format_string<Args...> text, Args&&... args) {
    std::string what = fmt::format(text, std::forward<Args>(args)...);
    if (strict_) fail_text(line, what);
    repairs.push_back({Severity::warning, line_place(line), std::move(what)});
  }

  template <class... Args>
  void note(std::size_t line, fmt::format_string<Args...> text, Args&&... args) {
    notes.push_back({Severity::note, line_place(line), fmt::format(text, std::forward<Args>(args)...)});
  }

  /// Throws InputError "name: line N: text".
  template <class... Args>
  [[noreturn]] void fail(std::size_t line, fmt::format_string<Args...> text, Args&&... args) const {
    fail_text(line, fmt::format(text, std::forward<Args>(args)...));
  }

  std::vector<Diagnostic> repairs, notes;

 private:
  [[noreturn]] void fail_text(std::size_t line, const std::string& what) const {
    throw_input_error(name_, line_place(line), "{}", what);
  }

  std::string name_;
  bool strict_;
};

}  // namespace lucerna
