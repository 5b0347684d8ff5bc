// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// How figures and data become HTML. All functions are pure and thread safe.
namespace lucerna {

/// Numbers as little-endian float32 in base 64: what the page's scripts read without a parser.
std::string base64_floats(std::span<const double> values);

/// Counts as little-endian 32-bit words in base 64.
std::string base64_counts(std::span<const std::uint32_t> values);

/// An SVG document as a part of a page: its ids get `prefix`, so that pictures do not share them, and it gets
/// role "img" with `label`. Throws InputError if `svg` does not begin as an SVG document.
std::string inline_svg(std::string_view svg, const std::string& prefix, std::string_view label);

/// <script type="application/json" id="...">: data for the scripts, safe whatever strings it holds.
std::string data_element(const std::string& id, const nlohmann::ordered_json& data);

/// A table in a box that scrolls by itself where the page is narrow. `head` and `rows` are HTML already; the
/// first cell of a row is its header; columns whose cells all begin with a digit, sign or dash are set right.
struct HtmlTable {
  std::string label;  ///< plain text; what the table shows
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
std::string html_table(const HtmlTable& table);

}  // namespace lucerna
