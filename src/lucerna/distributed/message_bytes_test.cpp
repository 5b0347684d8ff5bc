// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/message_bytes.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(MessageBytes, AreTakenInTheOrderTheyWereAppended) {
  const std::vector<float> floats{1.5F, -2.0F, 0.25F};
  const std::vector<std::uint32_t> none;
  std::string bytes;
  append(bytes, std::uint64_t{1} << 53);
  append(bytes, floats);
  append(bytes, none);
  append(bytes, std::uint64_t{7});
  EXPECT_EQ(bytes.size(), 8 + (8 + 12) + 8 + 8);

  std::string_view rest = bytes;
  std::vector<float> taken;
  std::vector<std::uint32_t> empty;
  EXPECT_EQ(take(rest), std::uint64_t{1} << 53);
  take(rest, taken);
  take(rest, empty);
  EXPECT_EQ(take(rest), 7);
  EXPECT_EQ(taken, floats);
  EXPECT_TRUE(empty.empty());
  EXPECT_TRUE(rest.empty());
}

}  // namespace
}  // namespace lucerna
