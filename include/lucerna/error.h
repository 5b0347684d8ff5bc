// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// What kind of thing is wrong, for programs; the text of the error is for people.
enum class ErrorCause {
  invalid,        ///< a value that cannot be, or one that the call cannot work with
  out_of_range,   ///< a number outside its range
  missing,        ///< something that is needed was not given
  unknown_key,    ///< a key of a project file that there is none of
  contradiction,  ///< two demands exclude each other
  mismatch,       ///< results that do not belong together: of other projects, versions or settings
  not_found,      ///< a file that is not there
  unreadable,     ///< a file that is there and cannot be read
  unwritable,     ///< a file or folder that cannot be written
  no_space,       ///< the disk is full
  damaged,        ///< a file that breaks its format
  unsupported,    ///< a device that is not there, or a feature that this build lacks
  usage,          ///< the call itself is wrong
  interrupted,    ///< the caller's Progress asked to stop
};

/// All of them, in order.
inline constexpr std::array kErrorCauses{
    ErrorCause::invalid,       ErrorCause::out_of_range, ErrorCause::missing,   ErrorCause::unknown_key,
    ErrorCause::contradiction, ErrorCause::mismatch,     ErrorCause::not_found, ErrorCause::unreadable,
    ErrorCause::unwritable,    ErrorCause::no_space,     ErrorCause::damaged,   ErrorCause::unsupported,
    ErrorCause::usage,         ErrorCause::interrupted};

/// The names above.
std::string_view to_string(ErrorCause cause);

/// Everything that Lucerna throws. The text says what is wrong, where, what was found and what was expected.
class Error : public std::runtime_error {
 public:
  /// Bytes of `what` that do not print, as those of a damaged file, are written as "\x00". `option` is a
  /// literal: it is not copied.
  Error(const std::string& what, ErrorCause cause, std::string_view option = {});
  /// What kind of thing is wrong.
  ErrorCause cause() const noexcept { return cause_; }
  /// The field of the call's options that would help: "salvage", "flux", "format", "device"; empty where none
  /// is known.
  std::string_view option() const noexcept { return option_; }

 private:
  ErrorCause cause_;
  std::string_view option_;
};

/// The input is bad: a file, a project, a set of rays.
class InputError : public Error {
 public:  /// With the text, what kind of thing is wrong, and the option that would help.
  explicit InputError(const std::string& what, ErrorCause cause = ErrorCause::invalid,
                      std::string_view option = {})
      : Error(what, cause, option) {}
};

/// The call itself is bad: an unknown option, a format that cannot be chosen.
class UsageError : public Error {
 public:  /// With the text, and the option that would help.
  explicit UsageError(const std::string& what, std::string_view option = {})
      : Error(what, ErrorCause::usage, option) {}
};

/// The caller's Progress asked to stop. What was whole has been written.
class Interrupted : public Error {
 public:
  Interrupted() : Error("interrupted", ErrorCause::interrupted) {}
};

}  // namespace lucerna
#pragma GCC visibility pop
