// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lucerna {

/// A field of `result.json` or of what a command prints with `--json`.
struct ResultField {
  /// "detectors[].peak.intensity"; `*` represents a name that follows from the input, `**` for everything
  /// below.
  std::string_view path;
  /// "trace" (and merge), "design", or "both"; else the command: "info", "check", "compress", "compare",
  /// "bench".
  std::string_view of;
  /// "estimate" (value with its standard error), "box error", "number", "count", "text", "flag" or "group".
  std::string_view type;
  /// Empty for pure numbers; "light" is the unit of the sources' flux.
  std::string_view unit;
  std::string_view meaning;
};

/// Those of traces and designs, in the order of the files.
std::span<const ResultField> result_fields();

/// Those of the other commands, which follow those of every run ("both").
std::span<const ResultField> command_fields();

/// Whether `pattern` (ResultField::path) represents `path`.
bool stands_for(std::string_view pattern, std::string_view path);

/// The reference page of `result.json` and `--json`, in Markdown, from the tables.
std::string result_reference();

}  // namespace lucerna
