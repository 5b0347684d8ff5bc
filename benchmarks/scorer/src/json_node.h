// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "error.h"
#include "vec.h"

namespace bench {

/// A value of a JSON file that knows its file and its place in it. Every reader below throws InputError with
/// both where the value is not of the kind or range that is asked for.
class JsonNode {
 public:
  /// Reads a file; throws InputError where it is missing or no JSON.
  static JsonNode read(const std::string& file);
  JsonNode(std::string file, nlohmann::json value, std::string place = "")
      : file_(std::move(file)), place_(std::move(place)), value_(std::move(value)) {}

  bool has(const std::string& key) const { return value_.is_object() && value_.contains(key); }
  /// A key that must be there.
  JsonNode at(const std::string& key) const;
  /// Entries of a list.
  std::vector<JsonNode> items() const;
  /// Refuses keys that are not in the list.
  void only(const std::vector<std::string>& keys) const;

  std::string text() const;
  std::string one_of(const std::vector<std::string>& words) const;
  bool boolean() const;
  double number() const;
  double number_in(double low, double high) const;
  double positive() const;
  std::int64_t whole(std::int64_t low, std::int64_t high) const;
  std::vector<double> numbers(std::size_t count) const;
  std::vector<double> numbers() const;
  Vec3 vector() const;
  Frame frame() const;

  const nlohmann::json& json() const { return value_; }
  const std::string& file() const { return file_; }
  std::string place() const { return place_.empty() ? "top level" : place_; }
  [[noreturn]] void fail(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;

 private:
  std::string found() const;

  std::string file_, place_;
  nlohmann::json value_;
};

}  // namespace bench
