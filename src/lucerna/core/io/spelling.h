// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

/// What a misspelt key, command or option may have meant. All are thread safe; cost: the product of the
/// lengths of two words.
namespace lucerna {

using WordSet = std::set<std::string, std::less<>>;

/// The fewest letters that are put in, left out or replaced to make one word of the other (V. Levenshtein,
/// 1966).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// One letter too many, too few or wrong, or two that changed places. More would take one key for another.
bool is_misspelt(std::string_view word, std::string_view meant);

/// The member of `candidates` with the smallest edit distance to `word`; empty if there are none.
std::string nearest_word(std::string_view word, const WordSet& candidates);

/// The nearest word where it is near enough to be meant: at most a third of the letters, rounded up, differ.
/// Empty where none is.
std::string meant_word(std::string_view word, const WordSet& candidates);

}  // namespace lucerna
