// SPDX-License-Identifier: Apache-2.0
#include "json_node.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace bench {

namespace {

std::string list_of(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
  return out;
}

/// Values in values: what follows copies them, level by level.
constexpr int kDeepest = 50;

}  // namespace

JsonNode JsonNode::read(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file, "file", "nothing that can be opened", "a JSON file");
  try {
    const auto no_deeper = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
      if (depth > kDeepest)
        throw InputError(file, "file", "lists or objects more than 50 deep", "50 at most");
      return true;
    };
    return {file, nlohmann::json::parse(in, no_deeper)};
  } catch (const nlohmann::json::out_of_range&) {
    throw InputError(file, "file", "a number beyond 1e308", "numbers that a double holds");
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(file, "byte " + std::to_string(e.byte), "text that is no JSON", "JSON (RFC 8259)");
  }
}

std::string JsonNode::found() const {
  const std::string text = value_.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return text.size() <= 60 ? text : text.substr(0, 57) + "...";
}

void JsonNode::fail(const std::string& expected) const { fail(found(), expected); }
void JsonNode::fail(const std::string& found, const std::string& expected) const {
  throw InputError(file_, place(), found, expected);
}

JsonNode JsonNode::at(const std::string& key) const {
  if (!value_.is_object()) fail("an object with the key " + key);
  if (!value_.contains(key)) fail("no key " + key, "the key " + key);
  return {file_, value_[key], place_ + "/" + key};
}

std::vector<JsonNode> JsonNode::items() const {
  if (!value_.is_array()) fail("a list");
  std::vector<JsonNode> out;
  for (std::size_t i = 0; i < value_.size(); ++i)
    out.emplace_back(file_, value_[i], place_ + "/" + std::to_string(i));
  return out;
}

void JsonNode::only(const std::vector<std::string>& keys) const {
  if (!value_.is_object()) fail("an object with keys of " + list_of(keys));
  for (const auto& [key, value] : value_.items()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      fail("the unknown key " + key, "one of " + list_of(keys));
  }
}

std::string JsonNode::text() const {
  if (!value_.is_string()) fail("a text");
  return value_.get<std::string>();
}

std::string JsonNode::one_of(const std::vector<std::string>& words) const {
  const std::string word = text();
  if (std::find(words.begin(), words.end(), word) == words.end()) fail("one of " + list_of(words));
  return word;
}

bool JsonNode::boolean() const {
  if (!value_.is_boolean()) fail("true or false");
  return value_.get<bool>();
}

double JsonNode::number() const {
  if (!value_.is_number()) fail("a number");
  const double x = value_.get<double>();
  if (!std::isfinite(x)) fail("a finite number");
  return x;
}

double JsonNode::number_in(double low, double high) const {
  const double x = number();
  if (!(x >= low && x <= high)) fail("a number from " + shown(low) + " to " + shown(high));
  return x;
}

double JsonNode::positive() const {
  const double x = number();
  if (!(x > 0.0)) fail("a number > 0");
  return x;
}

std::int64_t JsonNode::whole(std::int64_t low, std::int64_t high) const {
  const double x = number();
  if (x != std::floor(x) || x < static_cast<double>(low) || x > static_cast<double>(high))
    fail("a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  return static_cast<std::int64_t>(x);
}

std::vector<double> JsonNode::numbers() const {
  std::vector<double> out;
  for (const JsonNode& n : items()) out.push_back(n.number());
  return out;
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
  std::vector<double> out = numbers();
  if (out.size() != count) fail(std::to_string(count) + " numbers");
  return out;
}

Vec3 JsonNode::vector() const {
  const auto v = numbers(3);
  return {v[0], v[1], v[2]};
}

Frame JsonNode::frame() const {
  only({"origin_mm", "x_axis", "z_axis"});
  Frame f;
  f.origin = at("origin_mm").vector();
  f.x = at("x_axis").vector();
  f.z = at("z_axis").vector();
  const auto is_unit = [](const Vec3& v) { return std::abs(length(v) - 1.0) < 1e-9; };
  if (!is_unit(f.x) || !is_unit(f.z) || std::abs(dot(f.x, f.z)) > 1e-9)
    fail("two axes of length 1 at right angles");
  f.y = cross(f.z, f.x);
  return f;
}

}  // namespace bench
