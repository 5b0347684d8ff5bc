// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/core/io/diagnostic_text.h"
#include "lucerna/core/io/error.h"

namespace lucerna {

/// The words of a `.bsdf` file without its comments, read one after the other. Errors name the file and the
/// line of the word that was read last.
class BsdfWords {
 public:
  /// Keeps views of `text`.
  BsdfWords(std::string_view text, std::string file);

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, line_place(line_), text, std::forward<Args>(args)...);
  }
  template <class... Args>
  [[noreturn]] void refuse(fmt::format_string<Args...> text, Args&&... args) const {
    throw InputError(
        fmt::format("{}: {}: {}", file_, line_place(line_), fmt::format(text, std::forward<Args>(args)...)),
        ErrorCause::unsupported);
  }
  /// As much of a word as a message shows.
  static std::string_view shown(std::string_view word) { return word.substr(0, 40); }

  std::size_t count() const { return words_.size(); }
  bool at_end() const { return at_ == words_.size(); }
  /// The next word, which is not read yet; empty at the end.
  std::string_view peek() const { return at_end() ? std::string_view() : words_[at_].text; }
  /// Is this one of the words, wherever?
  bool have(std::string_view word) const;

  std::string_view next(const char* expected);
  /// The line of the word that was read last.
  std::size_t line() const { return line_; }
  /// Errors name this line until the next word is read.
  void point_at(std::size_t line) { line_ = line; }
  /// Passes over what stands behind the last word on its line.
  void skip_line();
  double number(const char* expected);
  void require(std::string_view word);
  /// A count and as many ascending angles, each from `min` to `max`.
  std::vector<double> angles(const char* what, double min, double max);
  /// `n` values of a BRDF, one of which is above 0, added to `out`.
  void values(std::size_t n, std::vector<double>& out);
  /// The reflectance of an incidence, in (0, 1].
  double total();

 private:
  struct Word {
    std::string_view text;
    std::size_t line = 0;
  };
  std::string file_;
  std::vector<Word> words_;
  std::size_t at_ = 0, line_ = 0;
};

}  // namespace lucerna
