// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/number_table.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

class NumberTableTest : public testing::Test {
 protected:
  NumberTable read(const std::string& text, TableHeader header = TableHeader::optional) {
    write_file(dir / "t.csv", text);
    return read_number_table(dir / "t.csv", header);
  }
  std::string fault(const std::string& text, TableHeader header = TableHeader::optional) {
    return test::message_of<InputError>([&] { read(text, header); });
  }
  test::TempDir dir;
};

TEST_F(NumberTableTest, PartsNumbersByCommasSemicolonsAndBlanks) {
  const NumberTable t = read("r_mm,z_mm\r\n1,2\r\n\n# nothing here\n3;-4.5e1  # a comment\n +5\t6");
  EXPECT_EQ(t.columns, 2u);
  EXPECT_EQ(t.rows, 3u);
  EXPECT_EQ(t.numbers, (std::vector<double>{1, 2, 3, -45, 5, 6}));
  EXPECT_EQ(read("").rows, 0u);
  EXPECT_EQ(read("r,z\n").rows, 0u);
  EXPECT_EQ(read("\xEF\xBB\xBF"
                 "7,8\n")
                .numbers,
            (std::vector<double>{7, 8}))
      << "a byte order mark";
}

TEST_F(NumberTableTest, NamesLineAndColumnOfWhatIsNoNumber) {
  EXPECT_NE(fault("1,2\n3,x\n").find("line 2, column 2: found 'x'"), std::string::npos);
  EXPECT_NE(fault("1,2\nr,z\n").find("line 2, column 1"), std::string::npos)
      << "names come first or not at all";
  EXPECT_NE(fault("r,z\nr,z\n").find("line 2, column 1"), std::string::npos) << "one line of names";
  EXPECT_NE(fault("1,nan\n").find("line 1, column 2"), std::string::npos);
  EXPECT_NE(fault("inf,1\n").find("line 1, column 1"), std::string::npos);
  EXPECT_NE(fault("1e999,1\n").find("line 1, column 1"), std::string::npos);
  EXPECT_NE(fault("1,2\n3\n").find("line 2: found 1 numbers, expected 2"), std::string::npos);
  EXPECT_NE(fault("r,z\n1,2\n", TableHeader::none).find("line 1, column 1"), std::string::npos);
  EXPECT_THROW(read_number_table(dir / "none.csv"), InputError);
}

}  // namespace
}  // namespace lucerna
