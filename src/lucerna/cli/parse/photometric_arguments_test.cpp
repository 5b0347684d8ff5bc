// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/photometric_arguments.h"

#include <gtest/gtest.h>

namespace lucerna::cli {
namespace {

TEST(PhotometricArguments, FormatsAreNamedOrFollowFromTheEnding) {
  EXPECT_EQ(photometric_format_for("a.ldt", ""), PhotometricFormat::ldt);
  EXPECT_EQ(photometric_format_for("a.IES", ""), PhotometricFormat::ies_2019);
  EXPECT_EQ(photometric_format_for("a.ldt", "ies-2002"), PhotometricFormat::ies_2002);
  EXPECT_EQ(photometric_format_for("a.dat", "ldt"), PhotometricFormat::ldt);
  EXPECT_FALSE(photometric_format_for("a.dat", ""));
  EXPECT_FALSE(photometric_format_for("a.ldt", "tm25")) << "a name of rays";
}

}  // namespace
}  // namespace lucerna::cli
