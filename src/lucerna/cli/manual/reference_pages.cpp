// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/reference_pages.h"

#include <fmt/format.h>

#include <algorithm>

#include "lucerna/cli/manual/cli_reference.h"
#include "lucerna/error.h"
#include "lucerna/project/schema/project_reference.h"
#include "lucerna/results/json/result_fields.h"

namespace lucerna::cli {

namespace {

constexpr std::string_view kErrorsHead = R"(# Errors

The program prints an error as one line on standard error: `lucerna: FILE: place: what was found,
what was expected`. Its exit code is in [cli.md](cli.md).

The library throws. Everything that it throws is a `lucerna::Error`: an `InputError` for bad input,
a `UsageError` for a bad call, `Interrupted` where the caller's `Progress` asked to stop.
`Error::cause()` says what kind of thing is wrong, so that a program need not read the text.
`Error::option()` names the field of the call's options that would help, where there is one.
A broken invariant of the library's own is a `std::logic_error`: please report it.

`error_parts` takes the text apart: file, place, found, expected. In Python `path`, `place`,
`found`, `expected` and `cause` are attributes of `lucerna.InputError`, which bad calls raise too.
The causes not found, unreadable, unwritable and no space raise an `OSError` there, an interrupt a
`KeyboardInterrupt`.

| cause | `ErrorCause::` | meaning |
|---|---|---|
)";

std::string_view meaning(ErrorCause cause) {
  switch (cause) {
    case ErrorCause::invalid:
      return "A value that cannot be, or one that the call cannot work with.";
    case ErrorCause::out_of_range:
      return "A number outside its range.";
    case ErrorCause::missing:
      return "Something that is needed was not given: a key, a flux, a format.";
    case ErrorCause::unknown_key:
      return "A key of a project file that there is none of. The text names the nearest one, where one is "
             "near.";
    case ErrorCause::contradiction:
      return "Two demands exclude each other. The text names both.";
    case ErrorCause::mismatch:
      return "Results that do not belong together: of other projects, versions or settings.";
    case ErrorCause::not_found:
      return "A file that is not there.";
    case ErrorCause::unreadable:
      return "A file that is there and cannot be read.";
    case ErrorCause::unwritable:
      return "A file or folder that cannot be written.";
    case ErrorCause::no_space:
      return "The disk is full. What was there before is unchanged.";
    case ErrorCause::damaged:
      return "A file that breaks its format. The text has the byte or line, where there is one.";
    case ErrorCause::unsupported:
      return "A device that is not there, or what this build, or this kind of problem, cannot do.";
    case ErrorCause::usage:
      return "The call itself is wrong.";
    case ErrorCause::interrupted:
      return "The caller asked to stop. What was whole has been written.";
  }
  return "";
}

std::string error_reference() {
  std::string text(kErrorsHead);
  for (const ErrorCause cause : kErrorCauses) {
    std::string name(to_string(cause));
    std::replace(name.begin(), name.end(), ' ', '_');
    text += fmt::format("| {} | `{}` | {} |\n", to_string(cause), name, meaning(cause));
  }
  return text;
}

}  // namespace

std::map<std::string, std::string> reference_pages() {
  return {{"cli.md", cli_reference()},
          {"errors.md", error_reference()},
          {"project-file.md", project_reference()},
          {"result-json.md", result_reference()}};
}

}  // namespace lucerna::cli
