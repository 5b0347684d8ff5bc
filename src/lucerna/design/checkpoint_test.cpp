// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/checkpoint.h"

#include <gtest/gtest.h>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(Checkpoint, FitStateOutOfRangeIsInputError) {
  FitState state;
  state.parameters = {1.0, 2.0};
  const std::string text = checkpoint_text(state, "key");
  EXPECT_EQ(checkpoint_text(parse_checkpoint(text, "key"), "key"), text);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"intervals_x 1", "intervals_x 0"},
           {"intervals_x 1", "intervals_x 2000000000"},
           {"intervals_y 1", "intervals_y -3"},
           {"stage 0", "stage -1"},
           {"step 0", "step -1"},
           {"starts 1", "starts 2147483647"},
           {"search_restarts 0", "search_restarts -2"},
           {"search_restarts_left 0", "search_restarts_left 2147483647"},
           {"twin 0", "twin 2"},
           {"gate 0 0 0 1 1", "gate 0 0 0 1 2000000000"}}) {
    EXPECT_THROW(parse_checkpoint(replaced(text, from, to), "key"), InputError) << to;
  }
}

TEST(Checkpoint, SearchStateOutOfRangeIsInputError) {
  FreeFormState state;
  state.now.candidate = 7;
  state.now.level = 3;
  const std::string text = checkpoint_text(state, "key");
  EXPECT_EQ(checkpoint_text(parse_search_checkpoint(text, "key"), "key"), text);
  const std::string none = checkpoint_text(FreeFormState{}, "key");
  EXPECT_EQ(checkpoint_text(parse_search_checkpoint(none, "key"), "key"), none);
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"now 7 3 ", "now 7 4 "},
                                                        {"now 7 3 ", "now 7 -1 "},
                                                        {"now 7 3 ", "now -2 3 "},
                                                        {" 1 1 of", " 1 0 of"},
                                                        {"step 0", "step -1"},
                                                        {"begun 0", "begun 2147483647"}}) {
    EXPECT_THROW(parse_search_checkpoint(replaced(text, from, to), "key"), InputError) << to;
  }
}

}  // namespace

}  // namespace lucerna
