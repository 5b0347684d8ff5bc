// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/design/fit/fit_state.h"
#include "lucerna/design/search/free_form_state.h"

namespace lucerna {

/// The state of a fit as text: whole numbers and hexadecimal floats, so that it reads back to the same bits.
/// `key` says what problem it belongs to.
std::string checkpoint_text(const FitState& state, const std::string& key);
std::string checkpoint_text(const FreeFormState& state, const std::string& key);
/// Throws InputError if the text is no checkpoint, damaged, or of another key.
FitState parse_checkpoint(const std::string& text, const std::string& key);
FreeFormState parse_search_checkpoint(const std::string& text, const std::string& key);
/// How many evaluations were made when a checkpoint was written. Throws InputError as above.
int checkpoint_evaluations(const std::string& text);

}  // namespace lucerna
