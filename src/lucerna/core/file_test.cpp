// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/file.h"

#include <gtest/gtest.h>

#include <array>

#include "lucerna/core/error.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const test::TempDir dir;
  {
    OutputFile file(dir / "a");
    file.write("half");
  }
  EXPECT_EQ(entries(dir.path()), 0u);
  write_file(dir / "a", "old");
  {
    OutputFile file(dir / "a");
    file.write("half");
  }
  EXPECT_EQ(read_file(dir / "a", 100), "old");
  write_file(dir / "a", "new");
  EXPECT_EQ(read_file(dir / "a", 100), "new");
  EXPECT_EQ(entries(dir.path()), 1u);
}

TEST(OutputFile, PatchesWhatWasWritten) {
  const test::TempDir dir;
  OutputFile file(dir / "a");
  file.write("count=? and more");
  file.patch(6, std::as_bytes(std::span("7", 1)));
  file.write("!");
  file.commit();
  EXPECT_EQ(read_file(dir / "a", 100), "count=7 and more!");
}

TEST(OutputFile, AnUnwritablePlaceIsOneClearLine) {
  const test::TempDir dir;
  EXPECT_THROW(OutputFile(dir / "missing" / "a"), InputError);
  EXPECT_THROW(OutputFile(dir.path()), InputError);
}

TEST(InputFile, NamesWhatIsMissing) {
  const test::TempDir dir;
  EXPECT_THROW(InputFile(dir / "none"), InputError);
  EXPECT_THROW(InputFile(dir.path()), InputError);
  write_file(dir / "a", "12345");
  const InputFile file(dir / "a");
  std::array<std::byte, 4> four{};
  file.read_at(1, four);
  EXPECT_EQ(static_cast<char>(four[0]), '2');
  for (const std::uint64_t offset : {2ull, 5ull, 6ull, ~0ull})
    EXPECT_THROW(file.read_at(offset, four), InputError);
  EXPECT_THROW(read_file(dir / "a", 4), InputError);
}

TEST(Sha256, KnownAnswers) {
  const test::TempDir dir;
  write_file(dir / "a", "abc");  // FIPS 180-4 example
  EXPECT_EQ(sha256_of_file(dir / "a"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  write_file(dir / "b", "");
  EXPECT_EQ(sha256_of_file(dir / "b"), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Check, PrintsConditionAndValues) {
  const int i = 5, n = 3;
  try {
    LUCERNA_CHECK(i < n, "i = {}, n = {}", i, n);
    FAIL();
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("i < n (i = 5, n = 3)"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace lucerna
