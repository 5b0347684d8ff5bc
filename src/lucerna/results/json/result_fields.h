// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lucerna {

/// A field of `result.json`.
struct ResultField {
  /// "detectors[].peak.intensity"; `*` represents a name that follows from the input, `**` for everything
  /// below.
  std::string_view path;
  /// "trace" (and merge), "design", or "both".
  std::string_view of;
  /// "estimate" (value with its standard error), "box error", "number", "count", "text", "flag" or "group".
  std::string_view type;
  /// Empty for pure numbers; "light" is the unit of the sources' flux.
  std::string_view unit;
  std::string_view meaning;
};

/// All of them, in the order of the files.
std::span<const ResultField> result_fields();

/// Whether `pattern` (ResultField::path) represents `path`.
bool stands_for(std::string_view pattern, std::string_view path);

/// The reference page of `result.json`, in Markdown, from the table.
std::string result_reference();

}  // namespace lucerna
