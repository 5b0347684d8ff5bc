// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/height_field/height_map.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A NumPy file of version 1.
std::string npy(const std::string& type, bool columns_first, const std::string& shape,
                const std::string& data) {
  std::string head = "{'descr': '" + type + "', 'fortran_order': " + (columns_first ? "True" : "False") +
                     ", 'shape': (" + shape + "), }";
  head.resize((head.size() + 10 + 64) / 64 * 64 - 10, ' ');
  head.back() = '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(head.size() & 0xff);
  file += static_cast<char>(head.size() >> 8);
  return file + head + data;
}

template <class T>
std::string bytes(const std::vector<double>& values, bool reversed = false) {
  std::string out;
  for (const double v : values) {
    const T x = static_cast<T>(v);
    std::string one(reinterpret_cast<const char*>(&x), sizeof x);
    if (reversed) one.assign(one.rbegin(), one.rend());
    out += one;
  }
  return out;
}

/// z = 10 row + column of 4 rows and 5 columns.
std::vector<double> ramp(bool columns_first = false) {
  std::vector<double> z;
  for (int i = 0; i < 20; ++i) z.push_back(columns_first ? 10 * (i % 4) + i / 4 : 10 * (i / 5) + i % 5);
  return z;
}

TEST(HeightMap, EveryFormHoldsTheSameHeights) {
  const test::TempDir dir;
  std::string csv = "# a mirror\n", pgm = "P2 5 4 1000\n";
  for (int i = 0; i < 20; ++i) {
    csv += fmt::format("{}{}", 10 * (i / 5) + i % 5, i % 5 < 4 ? (i % 2 == 0 ? "; " : ",") : "\r\n");
    pgm += fmt::format("{} ", 10 * (i / 5) + i % 5);
  }
  const auto check = [&](const std::string& name, const std::string& content) {
    write_file(dir / name, content);
    const HeightMap map = read_height_map(dir / name, FirstRow::bottom);
    EXPECT_EQ(map.nx, 5u) << name;
    EXPECT_EQ(map.ny, 4u) << name;
    EXPECT_EQ(map.z, ramp()) << name;
    EXPECT_EQ(map.white.has_value(), name == "a.pgm");
  };
  check("a.csv", csv);
  check("a.pgm", pgm);
  check("a.npy", npy("<f8", false, "4, 5", bytes<double>(ramp())));
  check("b.npy", npy("<f4", false, "4, 5", bytes<float>(ramp())));
  check("c.npy", npy(">f8", false, "4, 5", bytes<double>(ramp(), true)));
  check("d.npy", npy("|u1", false, "4, 5", bytes<std::uint8_t>(ramp())));
  check("e.npy", npy(">i2", false, "4, 5", bytes<std::int16_t>(ramp(), true)));
  check("f.NPY", npy("<f8", true, "4, 5", bytes<double>(ramp(true))));
  EXPECT_EQ(read_height_map(dir / "a.csv").z.front(), 30.0) << "as it looks: the last row is the lowest y";
  EXPECT_EQ(read_height_map(dir / "a.pgm").z.front(), 30.0);
  std::vector<double> negative(20, -300.0);
  write_file(dir / "n.npy", npy("<i2", false, "4, 5", bytes<std::int16_t>(negative)));
  EXPECT_EQ(read_height_map(dir / "n.npy").z, negative);
}

TEST(HeightMap, FaultsHaveTheirPlace) {
  const test::TempDir dir;
  const auto fault = [&](const std::string& name, const std::string& content) {
    write_file(dir / name, content);
    return test::message_of<InputError>([&] { read_height_map(dir / name); });
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(fault("a.csv", "1,2,3,4\n1,2,nan,4\n"), "a.csv: line 2, column 3: found 'nan'");
  expect(fault("a.csv", "1,2,3,4\n\n1,2,3\n"), "line 3: found 3 numbers, expected 4");
  expect(fault("a.csv", "x,y\n"), "line 1, column 1: found 'x'");
  expect(fault("a.csv", "1,2,3\n1,2,3\n1,2,3\n"), "3 x 3 heights, expected at least 4 x 4");
  expect(fault("a.csv", ""), "0 x 0");
  expect(fault("a.tif", "II"), "ends in '.tif'");
  std::vector<double> holed = ramp();
  holed[7] = std::nan("");
  expect(fault("a.npy", npy("<f8", false, "4, 5", bytes<double>(holed))), "row 2, column 3: found nan");
  expect(fault("a.npy", npy("<c8", false, "4, 5", bytes<double>(ramp()))), "type '<c8'");
  expect(fault("a.npy", npy("<f8", false, "20,", bytes<double>(ramp()))), "1 dimensions");
  expect(fault("a.npy", npy("<f8", false, "4, 6", bytes<double>(ramp()))), "160 bytes of data, expected 192");
  expect(fault("a.npy", npy("<f8", false, "4294967296, 4294967296", "")), "expected 4 x 4 to");
  expect(fault("a.npy", "\x93NUMPY"), "no NumPy");
}

TEST(HeightMapFuzz, DamagedFilesAreRefusedOrMaps) {
  const test::TempDir dir;
  const std::string good = npy("<f4", false, "4, 5", bytes<float>(ramp()));
  Rng rng(4, 0);
  for (int i = 0; i < 600; ++i) {
    std::string bad = good;
    if (i % 3 == 0) bad.resize(rng.bits() % bad.size());
    for (int k = 0; k < 3 && !bad.empty(); ++k)
      bad[rng.bits() % std::min<std::size_t>(bad.size(), 90)] = static_cast<char>(rng.bits());
    write_file(dir / "x.npy", bad);
    try {
      const HeightMap map = read_height_map(dir / "x.npy");
      EXPECT_EQ(map.z.size(), map.nx * map.ny);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace lucerna
