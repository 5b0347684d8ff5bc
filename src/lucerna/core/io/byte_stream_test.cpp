// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/byte_stream.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lucerna/core/io/sha256.h"
#include "lucerna/random.h"
#include "tests/support/gzip.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// Half of it compresses well.
std::string some_bytes(std::size_t n) {
  Rng rng(1, 0);
  std::string out(n, 'a');
  for (std::size_t i = 0; i < n / 2; ++i)
    out[i] = static_cast<char>(static_cast<int>(256.0 * rng.uniform()) - 128);
  return out;
}

/// All of a stream, in pieces of `piece` bytes.
std::string read_all(ByteStream& stream, std::size_t piece) {
  std::string out;
  std::vector<std::byte> part(piece);
  for (;;) {
    const std::size_t got = stream.read(part);
    out.append(reinterpret_cast<const char*>(part.data()), got);
    EXPECT_EQ(stream.position(), out.size());
    if (got < piece) return out;
  }
}

TEST(ByteStream, GivesTheBytesOfPlainAndPackedFiles) {
  const test::TempDir dir;
  const std::string bytes = some_bytes(300000);
  write_file(dir / "plain", bytes);
  write_file(dir / "one", test::gzipped(bytes));
  write_file(dir / "three",
             test::gzipped(bytes.substr(0, 7)) + test::gzipped("") + test::gzipped(bytes.substr(7)));
  for (const char* name : {"plain", "one", "three"}) {
    for (const std::size_t piece : {std::size_t{999}, std::size_t{65536}, std::size_t{400000}}) {
      ByteStream stream{InputFile(dir / name)};
      EXPECT_EQ(stream.is_packed(), std::string(name) != "plain");
      EXPECT_GE(stream.most_left(), bytes.size()) << name;
      EXPECT_TRUE(read_all(stream, piece) == bytes) << name << ' ' << piece;
      EXPECT_EQ(stream.fault(), "") << name;
      std::byte more{};
      EXPECT_EQ(stream.read({&more, 1}), 0u) << "after its end";
    }
  }
}

TEST(ByteStream, PlainBytesThatAreLeftAreCounted) {
  const test::TempDir dir;
  write_file(dir / "a", "12345");
  ByteStream stream{InputFile(dir / "a")};
  std::vector<std::byte> two(2);
  EXPECT_EQ(stream.most_left(), 5u);
  stream.read(two);
  EXPECT_EQ(stream.most_left(), 3u);
}

// What could be unpacked comes, and a fault: never bytes that were not packed.
TEST(ByteStream, APackedFileCutAnywhereSaysSo) {
  const test::TempDir dir;
  const std::string bytes = some_bytes(2000), packed = test::gzipped(bytes);
  for (std::size_t n = 2; n < packed.size(); ++n) {
    write_file(dir / "cut", packed.substr(0, n));
    ByteStream stream{InputFile(dir / "cut")};
    const std::string got = read_all(stream, 500);
    ASSERT_NE(stream.fault(), "") << n;
    ASSERT_EQ(got, bytes.substr(0, got.size())) << n;
  }
}

TEST(ByteStream, DamageIsAFaultWithItsPlace) {
  const test::TempDir dir;
  std::string packed = test::gzipped(some_bytes(2000));
  packed[packed.size() / 2] = static_cast<char>(packed[packed.size() / 2] ^ 0x55);
  write_file(dir / "damaged", packed);
  ByteStream stream{InputFile(dir / "damaged")};
  read_all(stream, 4000);
  EXPECT_NE(stream.fault().find("damaged before byte "), std::string::npos) << stream.fault();
}

TEST(Sha256, OfATextIsThatOfItsFile) {
  const test::TempDir dir;
  EXPECT_EQ(sha256_of_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::string bytes = some_bytes(100000);
  write_file(dir / "a", bytes);
  EXPECT_EQ(sha256_of_text(bytes), sha256_of_file(dir / "a"));
}

}  // namespace
}  // namespace lucerna
