// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>

/// The fields of results as JSON, held against the tables of results/json/result_fields.h.
namespace lucerna::test {

/// The paths of all fields below `json` ("detectors[].peak.intensity"): estimates and arrays of numbers are
/// one field each. An empty array of objects has none.
std::set<std::string> result_paths(const nlohmann::ordered_json& json);

/// Those of these paths that no field with ResultField::of in `of` represents. What does represent one is
/// taken out of `unseen`.
std::set<std::string> unknown_paths(const nlohmann::ordered_json& json, const std::set<std::string_view>& of,
                                    std::set<std::string_view>& unseen);

}  // namespace lucerna::test
