// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/diagnostic_text.h"

#include <fmt/format.h>

#include <charconv>
#include <utility>

namespace lucerna {

namespace {

constexpr std::string_view kLinePlace = "line ";

}  // namespace

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "";
}

std::string to_string(const Diagnostic& diagnostic) {
  if (diagnostic.place.empty()) return diagnostic.text;
  return fmt::format("{}: {}", diagnostic.place, diagnostic.text);
}

Diagnostic diagnostic(Severity severity, std::string message) {
  for (const std::string_view word : {kLinePlace, std::string_view("byte "), std::string_view("ray ")}) {
    const std::size_t colon = message.find(": ");
    if (!message.starts_with(word) || colon == message.npos) continue;
    return {severity, message.substr(0, colon), message.substr(colon + 2)};
  }
  return {severity, "", std::move(message)};
}

Diagnostic diagnostic(const InputError& error, const std::filesystem::path& path) {
  std::string text = error.what();
  if (const std::string name = path.string() + ": "; text.starts_with(name)) text.erase(0, name.size());
  return diagnostic(Severity::error, std::move(text));
}

std::string line_place(std::size_t line) { return line > 0 ? fmt::format("{}{}", kLinePlace, line) : ""; }

std::size_t line_of(const Diagnostic& diagnostic) {
  std::size_t line = 0;
  const std::string_view place = diagnostic.place;
  if (place.starts_with(kLinePlace)) {
    std::from_chars(place.data() + kLinePlace.size(), place.data() + place.size(), line);
  }
  return line;
}

}  // namespace lucerna
