// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace lucerna::cli {

/// What is wrong with a command line that `app` could not parse, in one line without a name before it: the
/// word that is not known, the one that may have been meant, and where help is.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv);

}  // namespace lucerna::cli
