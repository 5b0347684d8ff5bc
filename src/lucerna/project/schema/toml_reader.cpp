// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/spelling.h"
#include "lucerna/project/schema/toml_text.h"

namespace lucerna {

namespace {

/// Larger project files than this are something else.
constexpr std::uint64_t kLargestProject = 64 << 20;

/// A word without what stands after its last underscore: "focal" of "focal_mm".
std::string_view without_unit(std::string_view key) { return key.substr(0, key.rfind('_')); }

/// Misspelt, or with another unit or none: "focal_in" or "focal" for "focal_mm".
bool is_meant(std::string_view word, std::string_view key) {
  if (is_misspelt(word, key)) return true;
  return !unit_of(key).empty() && without_unit(word) == without_unit(key);
}

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date";
  }
}

/// "target.zone" of "target.zone[2]".
std::string without_numbers(std::string_view path) {
  std::string text;
  bool inside = false;
  for (const char c : path) {
    inside = (inside || c == '[') && c != ']';
    if (!inside && c != ']') text += c;
  }
  return text;
}

/// Where a node stands; a table under a header has no line of its own, so its first entry's. 0: nowhere.
toml::source_index first_line(const toml::node& node) {
  toml::source_index line = node.source().begin.line;
  if (line > 0 || !node.is_table()) return line;
  for (const auto& entry : *node.as_table()) {
    const toml::source_index at = entry.second.source().begin.line;
    if (at > 0 && (line == 0 || at < line)) line = at;
  }
  return line;
}

}  // namespace

toml::table parse_toml_file(const std::filesystem::path& path) {
  return parse_toml_text(read_file(path, kLargestProject), path.string());
}

toml::table parse_toml_text(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    if (text.find('\0') != std::string_view::npos)
      throw InputError(fmt::format("{}: is no text; expected a project, which is a TOML file", name));
    const auto& begin = e.source().begin;
    throw_input_error(name, fmt::format("line {}, column {}", begin.line, begin.column), "{}",
                      e.description());
  }
}

TomlReader::TomlReader(const toml::table& table, std::string file, std::string path,
                       std::span<const ProjectKey> keys)
    : table_(&table),
      keys_(keys),
      file_(std::move(file)),
      path_(std::move(path)),
      table_path_(without_numbers(path_)) {}

const ProjectKey& TomlReader::key_of(std::string_view key) const {
  const ProjectKey* found = find_key(keys_, table_path_, key);
  LUCERNA_CHECK(found != nullptr, "table '{}', key '{}'", table_path_, key);
  return *found;
}

const toml::node* TomlReader::find(std::string_view key) {
  key_of(key);
  known_.emplace(key);
  return table_->get(key);
}

const toml::node* TomlReader::find(std::string_view key, std::initializer_list<KeyType> types) {
  const KeyType type = key_of(key).type;
  LUCERNA_CHECK(std::find(types.begin(), types.end(), type) != types.end(), "table '{}', key '{}', type {}",
                table_path_, key, static_cast<int>(type));
  return find(key);
}

bool TomlReader::has(std::string_view key) { return find(key) != nullptr; }

bool TomlReader::has_array(std::string_view key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_array();
}

std::string TomlReader::full_key(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

std::string TomlReader::misspelt(std::string_view key) const {
  for (const auto& [other, node] : *table_) {
    const std::string_view name = other.str();
    const bool known = known_.contains(name) || find_key(keys_, table_path_, name) != nullptr;
    if (!known && is_meant(name, key)) return std::string(name);
  }
  return "";
}

void TomlReader::missing(std::string_view key, const std::string& what) const {
  const std::string typed = misspelt(key);
  if (typed.empty()) fail(key, what.empty() ? "is missing" : "is missing: " + what, ErrorCause::missing);
  fail(typed, fmt::format("unknown key; the nearest known one is '{}', which is missing", key),
       ErrorCause::unknown_key);
}

void TomlReader::fail(std::string_view key, const std::string& what, ErrorCause cause) const {
  const toml::node* node = table_->get(key);
  const auto line = first_line(node != nullptr ? *node : *table_);
  const std::string place = line > 0 ? fmt::format("line {}: ", line) : "";
  throw InputError(fmt::format("{}: {}{}: {}", file_, place, full_key(key), what), cause);
}

double TomlReader::to_number(const toml::node& node, std::string_view key) const {
  const auto value = node.value<double>();
  if (!value || node.is_boolean()) fail(key, fmt::format("found {}, expected a number", type_name(node)));
  if (!std::isfinite(*value)) fail(key, fmt::format("found {}, expected a finite number", *value));
  const KeyRange& range = key_of(key).range;
  if (!range.contains(*value)) {
    fail(key, fmt::format("found {}, expected {}", *value, range.text()), ErrorCause::out_of_range);
  }
  return *value;
}

const toml::array& TomlReader::to_array(const toml::node& node, std::string_view key,
                                        std::string_view expected) const {
  if (!node.is_array()) fail(key, fmt::format("found {}, expected {}", type_name(node), expected));
  return *node.as_array();
}

std::optional<double> TomlReader::number(std::string_view key) {
  const toml::node* node = find(key, {KeyType::number, KeyType::number_or_pairs});
  if (node == nullptr) return std::nullopt;
  return to_number(*node, key);
}

std::optional<std::string> TomlReader::text(std::string_view key) {
  const toml::node* node = find(key, {KeyType::text, KeyType::word, KeyType::file});
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) fail(key, fmt::format("found {}, expected a string", type_name(*node)));
  return node->as_string()->get();
}

std::optional<std::string> TomlReader::word(std::string_view key) {
  auto found = text(key);
  const std::string_view words = key_of(key).words;
  LUCERNA_CHECK(!words.empty(), "table '{}', key '{}' has no words", table_path_, key);
  const bool known =
      !found || (found->find(' ') == std::string::npos && !found->empty() &&
                 fmt::format(" {} ", words).find(fmt::format(" {} ", *found)) != std::string::npos);
  if (!known) fail(key, fmt::format("found '{}', expected {}", *found, alternatives(words)));
  return found;
}

std::string TomlReader::required_word(std::string_view key) {
  auto found = word(key);
  if (!found) missing(key);
  return *found;
}

double TomlReader::required_number(std::string_view key, const std::string& what) {
  const auto found = number(key);
  if (!found) missing(key, what);
  return *found;
}

std::optional<bool> TomlReader::flag(std::string_view key) {
  const toml::node* node = find(key, {KeyType::flag});
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) fail(key, fmt::format("found {}, expected true or false", type_name(*node)));
  return node->as_boolean()->get();
}

std::optional<std::vector<double>> TomlReader::numbers(std::string_view key) {
  const toml::node* node =
      find(key, {KeyType::numbers, KeyType::number_or_numbers, KeyType::vector, KeyType::axis});
  if (node == nullptr) return std::nullopt;
  std::vector<double> values;
  for (const toml::node& item : to_array(*node, key, "an array of numbers"))
    values.push_back(to_number(item, key));
  return values;
}

std::optional<std::vector<double>> TomlReader::numbers(std::string_view key, std::size_t n) {
  auto values = numbers(key);
  if (values && values->size() != n) {
    fail(key, fmt::format("found {} numbers, expected {}", values->size(), n));
  }
  return values;
}

std::optional<std::vector<double>> TomlReader::number_or_numbers(std::string_view key) {
  const toml::node* node = find(key, {KeyType::number_or_numbers});
  if (node != nullptr && !node->is_array()) return std::vector{to_number(*node, key)};
  return numbers(key);
}

std::optional<Vec3> TomlReader::vector(std::string_view key) {
  const auto values = numbers(key, 3);
  if (!values) return std::nullopt;
  return Vec3{(*values)[0], (*values)[1], (*values)[2]};
}

std::optional<Direction> TomlReader::axis(std::string_view key) {
  static const std::map<std::string, Vec3, std::less<>> kNames{
      {"x", {1, 0, 0}},   {"+x", {1, 0, 0}}, {"-x", {-1, 0, 0}}, {"y", {0, 1, 0}},  {"+y", {0, 1, 0}},
      {"-y", {0, -1, 0}}, {"z", {0, 0, 1}},  {"+z", {0, 0, 1}},  {"-z", {0, 0, -1}}};
  const toml::node* node = find(key, {KeyType::axis});
  if (node == nullptr) return std::nullopt;
  if (node->is_string()) {
    const auto found = kNames.find(node->as_string()->get());
    if (found == kNames.end()) {
      fail(key,
           fmt::format("found '{}', expected +x, -x, +y, -y, +z, -z or a vector", node->as_string()->get()));
    }
    return Direction::from_unit(found->second);
  }
  const Vec3 v = *vector(key);
  if (length(v) == 0.0) fail(key, "found the zero vector, expected a direction");
  return Direction::from(v);
}

std::optional<std::vector<std::array<double, 2>>> TomlReader::pairs(std::string_view key) {
  constexpr std::string_view kExpected = "an array of pairs, [[a, b], ...]";
  const toml::node* node = find(key, {KeyType::pairs, KeyType::number_or_pairs});
  if (node == nullptr) return std::nullopt;
  std::vector<std::array<double, 2>> all;
  for (const toml::node& item : to_array(*node, key, kExpected)) {
    const toml::array& pair = to_array(item, key, kExpected);
    if (pair.size() != 2)
      fail(key, fmt::format("item {} has {} numbers, expected 2", all.size() + 1, pair.size()));
    all.push_back({to_number(pair[0], key), to_number(pair[1], key)});
  }
  return all;
}

std::optional<std::filesystem::path> TomlReader::file(std::string_view key) {
  const auto name = text(key);
  if (!name) return std::nullopt;
  if (name->empty()) fail(key, "found an empty file name");
  return std::filesystem::path(file_).parent_path() / *name;
}

std::optional<TomlReader> TomlReader::table(std::string_view key) {
  const toml::node* node = find(key, {KeyType::table});
  if (node == nullptr) return std::nullopt;
  if (!node->is_table())
    fail(key, fmt::format("found {}, expected a table [{}]", type_name(*node), full_key(key)));
  return TomlReader(*node->as_table(), file_, full_key(key), keys_);
}

std::vector<TomlReader> TomlReader::tables(std::string_view key) {
  const toml::node* node = find(key, {KeyType::tables});
  if (node == nullptr) return {};
  std::vector<TomlReader> all;
  if (!node->is_array_of_tables()) {
    fail(key, fmt::format("found {}, expected tables [[{}]]", type_name(*node), full_key(key)));
  }
  for (const toml::node& item : *node->as_array()) {
    all.push_back(
        TomlReader(*item.as_table(), file_, fmt::format("{}[{}]", full_key(key), all.size()), keys_));
  }
  return all;
}

void TomlReader::finish() const {
  for (const auto& [key, node] : *table_) {
    const std::string_view word = key.str();
    if (known_.contains(word)) continue;
    fail(word, why_unknown(word), ErrorCause::unknown_key);
  }
}

std::string TomlReader::why_unknown(std::string_view word) const {
  if (find_key(keys_, table_path_, word) != nullptr) {
    const std::string table = table_path_.empty() ? "this file" : fmt::format("[{}]", table_path_);
    return fmt::format("has a meaning only with other keys of {} than are here", table);
  }
  const auto meant = std::ranges::find_if(known_, [&](const auto& k) { return is_meant(word, k); });
  const auto elsewhere = std::ranges::find(keys_, word, &ProjectKey::key);
  if (meant == known_.end() && elsewhere != keys_.end() && !elsewhere->table.empty())
    return fmt::format("unknown key here; [{}] has one of this name", elsewhere->table);
  const std::string nearest = meant != known_.end() ? *meant : nearest_word(word, known_);
  return nearest.empty() ? "unknown key" : fmt::format("unknown key; the nearest known one is '{}'", nearest);
}

}  // namespace lucerna
