// SPDX-License-Identifier: Apache-2.0
#include "lucerna/error.h"

#include <gtest/gtest.h>

#include <string>

namespace lucerna {
namespace {

TEST(Error, ShowsBytesThatDoNotPrint) {
  using namespace std::string_literals;
  EXPECT_STREQ(InputError("a.bsdf: line 3: found 'AO\0I', expected a key"s).what(),
               "a.bsdf: line 3: found 'AO\\x00I', expected a key");
  EXPECT_STREQ(InputError("found '\x1b[31m\x7f'").what(), "found '\\x1b[31m\\x7f'");
}

TEST(Error, LeavesTextAsItIs) {
  EXPECT_STREQ(UsageError("30 \u00b5m,\tone\nand two").what(), "30 \u00b5m,\tone\nand two");
}

TEST(Error, EachCauseHasANameOfItsOwn) {
  for (const ErrorCause a : kErrorCauses) {
    EXPECT_FALSE(to_string(a).empty());
    for (const ErrorCause b : kErrorCauses) EXPECT_EQ(a == b, to_string(a) == to_string(b));
  }
}

}  // namespace
}  // namespace lucerna
