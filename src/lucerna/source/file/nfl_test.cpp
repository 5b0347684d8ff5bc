// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/file/nfl.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

NflFile example() {
  NflFile file{{'T', 'E', 'S', 'T'}, 123.5, FluxUnit::watt, 77, {}};
  file.add({'A', 'A', 'A', 'A'}, "some bytes");
  file.add({'B', 'B', 'B', 'B'}, "");
  file.add({'C', 'C', 'C', 'C'}, std::string(50'000, 'x'));
  return file;
}

TEST(Nfl, TheVersionIsWhatTheFileNeedsAndNewerOnesAreRefused) {
  NflFile file = example();
  EXPECT_EQ(encode_nfl(file)[8], 1);
  file.version = 2;
  const std::string bytes = encode_nfl(file);
  EXPECT_EQ(bytes[8], 2);
  EXPECT_EQ(decode_nfl(bytes, "x").version, 2u);
  for (const std::uint32_t version : {0u, 3u}) {
    file.version = version;
    EXPECT_THROW(decode_nfl(encode_nfl(file), "x"), InputError);
  }
}

void expect_one_clear_line(const std::string& bytes, const std::string& what) {
  try {
    decode_nfl(bytes, "model.nfl");
    ADD_FAILURE() << what << " was read";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_EQ(text.find("model.nfl: "), 0u) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST(Nfl, ComesBackAsItWas) {
  const NflFile file = example();
  const std::string bytes = encode_nfl(file);
  EXPECT_EQ(bytes.substr(0, 8), kNflMagic);
  EXPECT_LT(bytes.size(), 500u);
  const NflFile back = decode_nfl(bytes, "x");
  EXPECT_EQ(back.method, file.method);
  EXPECT_EQ(back.flux, file.flux);
  EXPECT_EQ(back.flux_unit, file.flux_unit);
  EXPECT_EQ(back.training_rays, file.training_rays);
  ASSERT_EQ(back.sections.size(), file.sections.size());
  for (std::size_t i = 0; i < file.sections.size(); ++i) {
    EXPECT_EQ(back.sections[i].tag, file.sections[i].tag);
    EXPECT_EQ(back.sections[i].bytes, file.sections[i].bytes);
  }
}

TEST(NflFuzz, EveryCutAndEveryFlippedBitIsOneClearLine) {
  const std::string bytes = encode_nfl(example());
  for (std::size_t n = 0; n < bytes.size(); ++n) expect_one_clear_line(bytes.substr(0, n), "a cut file");
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::string flipped = bytes;
    flipped[i / 8] = static_cast<char>(flipped[i / 8] ^ (1 << (i % 8)));
    expect_one_clear_line(flipped, "a flipped bit");
  }
  expect_one_clear_line(bytes + "x", "a longer file");
}

TEST(Nfl, NumbersComeBack) {
  NflWriter w;
  const std::vector<std::uint64_t> values{0, 1, 127, 128, 300, 1ull << 31, ~0ull};
  for (const std::uint64_t x : values) w.varint(x);
  for (const std::int64_t x : {0, -1, 1, -64, 64, -100'000}) w.signed_varint(x);
  w.f64(-2.5);
  w.u32(0xdeadbeef);
  NflFile file;
  file.add({'N', 'U', 'M', 'S'}, w.take());
  NflReader r(file, {'N', 'U', 'M', 'S'}, "x");
  for (const std::uint64_t x : values) EXPECT_EQ(r.varint(), x);
  for (const std::int64_t x : {0, -1, 1, -64, 64, -100'000}) EXPECT_EQ(r.signed_varint(), x);
  EXPECT_EQ(r.f64(), -2.5);
  EXPECT_THROW(r.finish(), InputError);
  EXPECT_EQ(r.u32(), 0xdeadbeef);
  EXPECT_NO_THROW(r.finish());
  EXPECT_THROW(r.u8(), InputError);
  EXPECT_THROW(NflReader(file, {'N', 'O', 'N', 'E'}, "x"), InputError);
}

TEST(Nfl, NumbersThatAreNoneAreRefused) {
  NflWriter w;
  w.f64(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 12; ++i) w.u8(0xff);
  NflFile file;
  file.add({'N', 'U', 'M', 'S'}, w.take());
  NflReader r(file, {'N', 'U', 'M', 'S'}, "x");
  EXPECT_THROW(r.f64(), InputError);
  EXPECT_THROW(r.varint(), InputError);
}

}  // namespace
}  // namespace lucerna
