// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/project_reference.h"

#include <fmt/format.h>

#include "lucerna/project/schema/project_keys.h"

namespace lucerna {

namespace {

constexpr std::string_view kHead = R"(# Project files

A project is a [TOML](https://toml.io) file. It says which light falls on which mirror and what is
looked at; `lucerna trace` and `lucerna design` read it. `lucerna init` writes one with comments.

- Lengths are in mm, angles in degrees. The unit is part of a key's name.
- The luminaire frame has z up. Nadir (gamma 0) is -z, C0 is +x, C90 is +y.
- File names are relative to the folder of the project.
- A key that is not known is an error. The message names the line and, where one is near, the
  key that may be meant.
- A number out of its range is an error. The message names the line, what was found and the range.

This page is written by `make reference` from the table that the parser reads with.
)";

std::string_view type_text(KeyType type) {
  switch (type) {
    case KeyType::number:
      return "number";
    case KeyType::numbers:
      return "numbers [a, b, ...]";
    case KeyType::number_or_numbers:
      return "number or numbers";
    case KeyType::pairs:
      return "pairs [[a, b], ...]";
    case KeyType::number_or_pairs:
      return "number or pairs";
    case KeyType::vector:
      return "[x, y, z]";
    case KeyType::axis:
      return "axis: \"+x\" ... \"-z\" or [x, y, z]";
    case KeyType::flag:
      return "true or false";
    case KeyType::text:
      return "text";
    case KeyType::word:
      return "word";
    case KeyType::file:
      return "file name";
    case KeyType::table:
      return "table";
    case KeyType::tables:
      return "tables, any number";
  }
  return "";
}

/// What a value may be: words, or a range with its unit.
std::string value_text(const ProjectKey& key) {
  std::string text(type_text(key.type));
  if (!key.words.empty()) return text + ": " + alternatives(key.words);
  if (const std::string range = key.range.text(); !range.empty()) text += ", " + range;
  if (const std::string_view unit = unit_of(key.key); !unit.empty()) text += fmt::format(" ({})", unit);
  return text;
}

std::string heading(const ProjectKey& first) {
  if (first.table.empty()) return "The file";
  const std::size_t dot = first.table.rfind('.');
  const bool inner = dot != std::string_view::npos;
  const ProjectKey* self = find_key(project_keys(), inner ? first.table.substr(0, dot) : "",
                                    inner ? first.table.substr(dot + 1) : first.table);
  const bool many = self->type == KeyType::tables;
  return many ? fmt::format("`[[{}]]`", first.table) : fmt::format("`[{}]`", first.table);
}

}  // namespace

std::string project_reference() {
  std::string text(kHead);
  const ProjectKey* before = nullptr;
  for (const ProjectKey& key : project_keys()) {
    if (before == nullptr || before->table != key.table) {
      text +=
          fmt::format("\n## {}\n\n| key | value | default | meaning |\n|---|---|---|---|\n", heading(key));
    }
    text += fmt::format("| `{}` | {} | {} | {} |\n", key.key, value_text(key), key.otherwise, key.meaning);
    before = &key;
  }
  return text;
}

}  // namespace lucerna
