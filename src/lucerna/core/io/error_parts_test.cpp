// SPDX-License-Identifier: Apache-2.0
#include "lucerna/error_parts.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

void expect_parts(const std::string& text, const ErrorParts& parts, ErrorCause cause = ErrorCause::invalid) {
  const ErrorParts found = error_parts(InputError(text, cause));
  EXPECT_EQ(found.path, parts.path) << text;
  EXPECT_EQ(found.place, parts.place) << text;
  EXPECT_EQ(found.found, parts.found) << text;
  EXPECT_EQ(found.expected, parts.expected) << text;
}

TEST(ErrorParts, AreThoseOfTheText) {
  expect_parts("lamp.toml: line 7: reflector[0].focal_mm: found -3, expected > 0",
               {"lamp.toml", "line 7: reflector[0].focal_mm", "-3", "> 0"});
  expect_parts("a.ldt: line 3: found 'x', expected a number", {"a.ldt", "line 3", "'x'", "a number"});
  expect_parts("a.nfl: byte 12: method 'abcd' is not known; expected 'CLUS' or 'ADAP'",
               {"a.nfl", "byte 12", "method 'abcd' is not known", "'CLUS' or 'ADAP'"}, ErrorCause::damaged);
  expect_parts("lamp.toml: source: is missing", {"lamp.toml", "source", "", ""}, ErrorCause::missing);
  expect_parts("/a b/c.ldt: cannot read: No such file or directory", {"/a b/c.ldt", "", "", ""},
               ErrorCause::not_found);
}

TEST(ErrorParts, OfTextsWithoutAFile) {
  expect_parts("total flux 0, expected > 0", {"", "", "total flux 0", "> 0"});
  expect_parts("reflector: focal length is -1, expected a finite number above 0",
               {"", "", "focal length is -1", "a finite number above 0"});
  expect_parts("no rays to compress", {});
  expect_parts("", {});
  expect_parts("expected ", {});
  expect_parts(": : ", {});
}

}  // namespace
}  // namespace lucerna
