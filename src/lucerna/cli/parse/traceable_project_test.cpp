// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/traceable_project.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

using testing::HasSubstr;

std::string plate(const std::string& name, double from_mm) {
  return "[[body]]\nrole = 'solid'\nrefractive_index = 1.5\nname = '" + name + "'\noutline_mm = [[0, " +
         std::to_string(from_mm) + "], [5, " + std::to_string(from_mm) + "], [5, " +
         std::to_string(from_mm + 2.0) + "], [0, " + std::to_string(from_mm + 2.0) + "]]\n";
}

TEST(TraceableProject, BodiesThatMeetAreNamedWithTheFile) {
  const test::TempDir dir;
  const std::filesystem::path path = dir / "p.toml";
  write_file(path, "[[source]]\nkind = 'disk'\n" + plate("a", 3.0) + plate("b", 6.0));
  EXPECT_EQ(read_traceable_project(path).scene.solids.size(), 2u);
  write_file(path, "[[source]]\nkind = 'disk'\n" + plate("a", 3.0) + plate("b", 4.0));
  EXPECT_THAT(test::message_of<InputError>([&] { static_cast<void>(read_traceable_project(path)); }),
              HasSubstr("p.toml: solid 'b' and solid 'a'"));
}

TEST(TraceableProject, MirrorsWithinACoverGlassAreNamedWithTheFile) {
  const test::TempDir dir;
  const std::filesystem::path path = dir / "p.toml";
  const auto warnings = [&](double glass_mm) {
    write_file(path,
               "[[source]]\nkind = 'disk'\nposition_mm = [0, 0, 5]\n[[reflector]]\nfamily = "
               "'revolution'\npreset = 'parabola'\nfocal_mm = 20\ndiameter_mm = 100\n"
               "[[body]]\nrole = 'glass'\ndiameter_mm = 110\nposition_mm = [0, 0, " +
                   std::to_string(glass_mm) + "]\n");
    return read_traceable_project(path).warnings;
  };
  EXPECT_THAT(warnings(32.0), testing::IsEmpty());
  EXPECT_THAT(warnings(30.0), testing::ElementsAre(HasSubstr("p.toml: reflector 1 reaches into")));
}

}  // namespace
}  // namespace lucerna::cli
