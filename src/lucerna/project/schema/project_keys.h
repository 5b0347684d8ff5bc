// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// What a key of a project file holds.
enum class KeyType {
  number,
  numbers,            ///< [a, b, ...]
  number_or_numbers,  ///< a number, or an array of numbers
  pairs,              ///< [[a, b], [c, d], ...]
  number_or_pairs,    ///< a number, or an array of pairs
  vector,             ///< [x, y, z]
  axis,               ///< "+x" ... "-z", or [x, y, z]
  flag,               ///< true or false
  text,
  word,    ///< one of ProjectKey::words
  file,    ///< a file name, relative to the project's folder
  table,   ///< [table]
  tables,  ///< [[table]], any number
};

/// What a number may be; also each number of an array.
struct KeyRange {
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  bool min_excluded = false, max_excluded = false, whole = false;

  bool contains(double x) const;
  /// "> 0", "0 to 1", "a whole number from 1 to 60"; empty where every number is in it.
  std::string text() const;
};

/// A key that a project file may have.
struct ProjectKey {
  /// "" for the file itself, "source", "design.limits".
  std::string_view table, key;
  KeyType type;
  KeyRange range;
  /// Of a word, with a blank between them.
  std::string_view words;
  /// What counts where the key is missing, as one would write it or in words; "required" where it must be
  /// there.
  std::string_view otherwise;
  std::string_view meaning;
};

/// All keys, table after table. What a parser reads and what the reference page says are both of them:
/// TomlReader reads no other key, and refuses what is not in a key's range.
std::span<const ProjectKey> project_keys();

/// Null if there is none.
const ProjectKey* find_key(std::span<const ProjectKey> keys, std::string_view table, std::string_view key);

/// The unit that the ending of the key's name represents, as "mm"; empty for pure numbers, words and files.
std::string_view unit_of(std::string_view key);

/// "a", "a or b", "a, b or c", of words with a blank between them.
std::string alternatives(std::string_view words);

}  // namespace lucerna
