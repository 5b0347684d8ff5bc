// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lucerna {

/// A result's figures by JSON pointer (RFC 6901), as HTML. A figure stands in an element whose `data-key` is
/// its pointer, so that tests and readers find where it comes from. Throws InputError, naming file and key,
/// where one is missing or of the wrong kind. `json` must outlive it.
class ResultFigures {
 public:
  ResultFigures(const nlohmann::ordered_json& json, std::string file) : json_(json), file_(std::move(file)) {}

  bool has(const std::string& key) const;
  const nlohmann::ordered_json& at(const std::string& key) const;
  std::uint64_t count(const std::string& key) const;
  /// NaN for null; of an estimate ({value, standard_error}) its value.
  double number(const std::string& key) const;
  /// Escaped; what is no text as JSON writes it.
  std::string text(const std::string& key) const;
  std::string text_or_dash(const std::string& key) const { return has(key) ? text(key) : "–"; }
  /// As figure_text; with its error if it is an estimate or `error_key` is given. Null is a dash.
  std::string figure(const std::string& key, const std::string& error_key = "") const;
  /// To a fixed number of decimals.
  std::string fixed(const std::string& key, int decimals) const;
  /// A share in per cent: the element's `data-factor` is 100.
  std::string percent(const std::string& key, int decimals = 2) const;
  /// The same with its error, to the digits of figure_text.
  std::string percent(const std::string& key, const std::string& error_key) const;

 private:
  const nlohmann::ordered_json& json_;
  std::string file_;
};

/// A word of a JSON pointer with '/' and '~' escaped (RFC 6901, section 3).
std::string pointer_word(const std::string& key);

/// "12.34 %"; a dash where `whole` is not above 0.
std::string percent_text(double part, double whole);

/// One of the summary's cards; all HTML.
std::string card(const std::string& name, const std::string& value, const std::string& unit,
                 const std::string& note);

/// A definition list's entry; both HTML.
std::string fact(const std::string& name, const std::string& value);

/// Program, command, seed, wall times, inputs with hashes: what every result has.
/// `more` are facts of its own (`fact`), `project` the project file if there is one.
std::string provenance_html(const ResultFigures& result, const std::string& more, const std::string& project);

}  // namespace lucerna
