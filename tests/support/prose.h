// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// The form of a Markdown page: how long its lines and sentences are.
namespace lucerna::test {

/// Numbers (from 1) of the lines with more than `max_columns` characters that could be broken: not those of
/// code blocks and tables, nor a single word.
std::vector<std::size_t> long_lines(std::string_view page, std::size_t max_columns);

/// The sentences with more than `max_words` words: of paragraphs, items of lists, cells of tables, headings;
/// not of code blocks. A sentence ends at a point, question or exclamation mark before a blank and a capital
/// letter, digit or mark. A word has a letter or a digit.
std::vector<std::string> long_sentences(std::string_view page, std::size_t max_words);

/// Numbers (from 1) of the lines within a sentence that begin as something else does in Markdown, so that the
/// page loses or breaks them: '%' (a comment), "3. " or "- " (an item) behind a line that ends no clause.
std::vector<std::size_t> lines_taken_for_marks(std::string_view page);

}  // namespace lucerna::test
