// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/error.h"
#include "lucerna/geometry.h"
#include "lucerna/project/schema/project_keys.h"

namespace lucerna {

/// A table of a TOML file being read: every key that is asked for becomes a known one, and `finish` refuses
/// the rest by naming the nearest known key. A key must be one of `keys` and of the type that is asked for
/// (LUCERNA_CHECK); numbers must be in its range, words among its words. All errors are InputErrors with
/// file, line, key path, found and expected. Not thread safe; the toml::table must outlive it.
class TomlReader {
 public:
  /// `path` is the table's place for messages, as "reflector[0]"; empty for the root.
  TomlReader(const toml::table& table, std::string file, std::string path,
             std::span<const ProjectKey> keys = project_keys());

  bool has(std::string_view key);
  /// True if the key is there and holds an array.
  bool has_array(std::string_view key);
  std::optional<double> number(std::string_view key);
  double number(std::string_view key, double otherwise) { return number(key).value_or(otherwise); }
  std::optional<std::string> text(std::string_view key);
  /// One of the key's words.
  std::optional<std::string> word(std::string_view key);
  std::string required_word(std::string_view key);
  /// `what` as `missing` takes it.
  double required_number(std::string_view key, const std::string& what = {});
  std::optional<bool> flag(std::string_view key);
  /// Any number of numbers; with `n`, exactly that many.
  std::optional<std::vector<double>> numbers(std::string_view key);
  std::optional<std::vector<double>> numbers(std::string_view key, std::size_t n);
  /// A number by itself, or an array of numbers.
  std::optional<std::vector<double>> number_or_numbers(std::string_view key);
  std::optional<Vec3> vector(std::string_view key);
  /// "+x", "-x", ... "z", or three numbers, not all zero.
  std::optional<Direction> axis(std::string_view key);
  /// [[a, b], [c, d], ...].
  std::optional<std::vector<std::array<double, 2>>> pairs(std::string_view key);
  /// A file name; a relative one is taken from the TOML file's folder.
  std::optional<std::filesystem::path> file(std::string_view key);

  /// [key]; nothing when absent.
  std::optional<TomlReader> table(std::string_view key);
  /// [[key]], in order; empty when absent.
  std::vector<TomlReader> tables(std::string_view key);

  /// Throws for the first key that was never asked for. Call when all known keys have been.
  void finish() const;

  /// A required key that is not there, and what it is to say. Where a key that is not known is spelt nearly
  /// like it, that is the error.
  [[noreturn]] void missing(std::string_view key, const std::string& what = {}) const;

  /// An error at `key`: "project.toml: line 7: reflector[0].focal_mm: ...".
  [[noreturn]] void fail(std::string_view key, const std::string& what,
                         ErrorCause cause = ErrorCause::invalid) const;
  const std::string& path() const { return path_; }

 private:
  /// A key of the table that no table of this kind has and that looks like `key`, misspelt or with another
  /// unit; empty if there is none.
  std::string misspelt(std::string_view key) const;
  /// What the schema says of a key of this table.
  const ProjectKey& key_of(std::string_view key) const;
  const toml::node* find(std::string_view key);
  const toml::node* find(std::string_view key, std::initializer_list<KeyType> types);
  double to_number(const toml::node& node, std::string_view key) const;
  const toml::array& to_array(const toml::node& node, std::string_view key, std::string_view expected) const;
  std::string full_key(std::string_view key) const;
  /// Why `finish` refuses a key.
  std::string why_unknown(std::string_view key) const;

  const toml::table* table_;
  std::span<const ProjectKey> keys_;
  std::string file_, path_;
  /// `path_` without the numbers of tables.
  std::string table_path_;
  std::set<std::string, std::less<>> known_;
};

/// Parses a TOML file; syntax errors become InputErrors with line and column.
toml::table parse_toml_file(const std::filesystem::path& path);

}  // namespace lucerna
