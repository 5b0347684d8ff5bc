// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/input_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

using testing::HasSubstr;

class InputKind : public testing::Test {
 protected:
  std::string refusal(const std::string& name, const std::string& content) {
    write_file(dir_ / name, content);
    return refusal(dir_ / name);
  }
  static std::string refusal(const std::filesystem::path& path) {
    try {
      require_ray_file(path);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }
  test::TempDir dir_;
};

TEST_F(InputKind, SaysWhatIsNoRayFileAndWhoTakesIt) {
  EXPECT_THAT(refusal("p.toml", "[[source]]\n"), HasSubstr("a project file; lucerna trace"));
  EXPECT_THAT(refusal("p.TOML", "[[source]]\n"), HasSubstr("a project file; lucerna trace"));
  EXPECT_THAT(refusal("a.ies", "IESNA:LM-63-2019\n"), HasSubstr("a light distribution"));
  EXPECT_THAT(refusal(dir_ / ""), HasSubstr("a folder; lucerna check"));
  EXPECT_THAT(refusal("b.LDT", "\x01\x02\x03"), HasSubstr("neither an IES LM-63 nor a EULUMDAT file"));
  EXPECT_THAT(refusal("c.ldt", ""), HasSubstr("c.ldt: empty, the IES or EULUMDAT file expected that"));
}

TEST_F(InputKind, LeavesAllElseToTheReader) {
  EXPECT_EQ(refusal("rays.txt", "0 0 0 0 0 1 1\n"), "");
  EXPECT_EQ(refusal(dir_ / "absent"), "");
}

}  // namespace
}  // namespace lucerna::cli
