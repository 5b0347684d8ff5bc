// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/mcpl/mcpl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/mcpl/mcpl_direction.h"
#include "lucerna/rayset/formats/mcpl/mcpl_layout.h"
#include "tests/support/gzip.h"
#include "tests/support/paths.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::bytes_of, test::gzipped, test::message_of, test::patched, test::put_bytes, test::random_ray_set,
    test::TempDir;
using ::testing::AllOf, ::testing::Contains, ::testing::ElementsAre, ::testing::HasSubstr, ::testing::Not;
using At = McplHeaderBytes;

std::filesystem::path made(const std::string& name) { return test::source_dir() / "tests/data/mcpl" / name; }

/// All columns that the format has places for, values that it can hold.
RaySet full_mcpl_set(std::size_t n) {
  RaySet set = random_ray_set(n, 5,
                              {{ColumnKind::wavelength_nm, "wavelength nm"},
                               {ColumnKind::additional, "polarisation x"},
                               {ColumnKind::additional, "polarisation y"},
                               {ColumnKind::additional, "polarisation z"},
                               {ColumnKind::additional, "userflags"}});
  set.header.flux_unit = FluxUnit::watt;
  set.header.flux_lm.reset();
  set.header.flux_w = 1.25;
  for (std::size_t i = 0; i < n; ++i) set.rays.extra[4][i] = static_cast<float>(70000 * i);
  return set;
}

std::string written(const RaySet& set) {
  const TempDir dir;
  write_ray_set(dir / "a", set, "mcpl");
  return bytes_of(dir / "a");
}

TEST(McplDirection, EveryDirectionComesBack) {
  std::vector<Vec3> directions;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        if (x != 0.0 || y != 0.0 || z != 0.0) directions.push_back(Direction::from({x, y, z}));
      }
    }
  }
  const RaySet random = random_ray_set(2000, 3);
  for (std::size_t i = 0; i < 2000; ++i) directions.push_back(random.rays.direction(i));
  for (const Vec3& k : directions) {
    const Vec3 back = unpack_direction(pack_direction(k));
    EXPECT_LT(length(back - k), 4e-16) << k.x << " " << k.y << " " << k.z;
  }
}

/// The particles that tests/data/mcpl/make.c writes; `accuracy` is that of its numbers.
void expect_made(const RaySet& set, double weight_step, double accuracy) {
  ASSERT_EQ(set.rays.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto n = static_cast<double>(i);
    const double polar = 0.3 + 0.4 * n, azimuth = 1.1 * n, energy_mev = 2e-6 + 1e-7 * n;
    EXPECT_NEAR(length(set.rays.origin_mm(i) - Vec3{5.0 * n, -2.5 * n, 30.0}), 0.0, 40.0 * accuracy);
    const Vec3 k{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
    EXPECT_NEAR(length(set.rays.direction(i) - k), 0.0, 4.0 * accuracy) << i;
    // h c = 1239.84198 eV nm.
    EXPECT_NEAR(set.rays.extra[0][i], 1239.84198 / (1e6 * energy_mev), 600.0 * accuracy);
    const double photons = weight_step > 0.0 ? weight_step * (n + 1.0) : 2e18;
    EXPECT_NEAR(set.rays.weight[i], photons * 1e6 * energy_mev * 1.602176634e-19, 4.0 * accuracy) << i;
  }
}

TEST(Mcpl, FilesOfLibmcplHoldWhatTheirProgramWrote) {
  std::vector<std::string> warnings;
  const RaySet all = read_ray_set(made("all.mcpl"), {}, no_progress(), &warnings);
  expect_made(all, 1e18, 1.2e-7);
  ASSERT_EQ(all.header.columns.size(), 5u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(all.rays.extra[1][i], 0.125F * static_cast<float>(i));
    EXPECT_EQ(all.rays.extra[2][i], 0.5F);
    EXPECT_EQ(all.rays.extra[3][i], -0.25F);
    EXPECT_EQ(all.rays.extra[4][i], static_cast<float>(1000 + i));
  }
  EXPECT_EQ(all.header.columns[4].label, "userflags");
  EXPECT_EQ(all.header.texts.file_creator, "make.c");
  EXPECT_EQ(all.header.flux_unit, FluxUnit::watt);
  EXPECT_FALSE(all.header.flux().has_value()) << "no total is stated";
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("ray 3"), HasSubstr("times"), HasSubstr("0.5 ms"))));
  const auto reader = open_ray_file(made("small.mcpl.gz"));
  EXPECT_EQ(reader->format(), "mcpl");
  EXPECT_EQ(reader->length_unit(), "cm");
  expect_made(read_ray_set(made("small.mcpl.gz")), 0.0, 3e-7);
}

TEST(Mcpl, OtherParticlesAreFaultyRays) {
  EXPECT_THAT(message_of<InputError>([] { read_ray_set(made("mixed.mcpl")); }),
              AllOf(HasSubstr("mixed.mcpl: ray 2"), HasSubstr("PDG code 11 found"), HasSubstr("expected")));
  std::vector<std::string> warnings;
  const RaySet photons = read_ray_set(made("mixed.mcpl"), {.salvage = true}, no_progress(), &warnings);
  ASSERT_EQ(photons.rays.size(), 6u) << "code -22, a photon to Geant4, stays";
  EXPECT_NEAR(photons.rays.x_mm[5], 35.0F, 1e-5F);
  EXPECT_THAT(warnings, Contains(HasSubstr("PDG code 11")));
}

TEST(Mcpl, AWattIsSoManyPhotonsASecond) {
  RaySet set = random_ray_set(1, 1);
  set.header.flux_unit = FluxUnit::watt;
  set.header.wavelength_nm = 555.0F;
  set.rays.weight[0] = 1.0F;
  const std::string bytes = written(set);
  double energy_mev = 0.0, weight = 0.0;
  std::memcpy(&energy_mev, bytes.data() + bytes.size() - 24, 8);
  std::memcpy(&weight, bytes.data() + bytes.size() - 8, 8);
  // 2.79e18 at the peak of V(lambda): lambda / (h c).
  EXPECT_NEAR(std::abs(energy_mev), 6.62607015e-34 * 299792458.0 / 555e-9 / 1.602176634e-13, 1e-18);
  EXPECT_NEAR(weight / (555e-9 / (6.62607015e-34 * 299792458.0)), 1.0, 1e-14);
}

TEST(Mcpl, EveryColumnThatHasAPlaceComesBackAndASecondRoundKeepsEveryBit) {
  const TempDir dir;
  const RaySet set = full_mcpl_set(20000);
  EXPECT_THAT(write_ray_set(dir / "a", set, "mcpl"), ElementsAre());
  const RaySet once = read_ray_set(dir / "a");
  EXPECT_EQ(once.header, set.header);
  EXPECT_EQ(once.rays.extra, set.rays.extra);
  EXPECT_EQ(once.rays.weight, set.rays.weight);
  EXPECT_EQ(once.rays.x_mm, set.rays.x_mm);
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    // Four units in the last place of the largest cosine; the others keep their bits.
    EXPECT_NEAR(once.rays.kx[i], set.rays.kx[i], std::abs(set.rays.kx[i]) > 0.577F ? 2.4e-7F : 0.0F);
    EXPECT_NEAR(once.rays.ky[i], set.rays.ky[i], std::abs(set.rays.ky[i]) > 0.577F ? 2.4e-7F : 0.0F);
    EXPECT_NEAR(once.rays.kz[i], set.rays.kz[i], std::abs(set.rays.kz[i]) > 0.577F ? 2.4e-7F : 0.0F);
  }
  write_ray_set(dir / "b", once, "mcpl");
  EXPECT_EQ(read_ray_set(dir / "b"), once);
}

TEST(Mcpl, WhatCannotBeKeptIsNamed) {
  const TempDir dir;
  RaySet set = full_mcpl_set(4);
  set.rays.extra[4] = {0.5F, -1.0F, std::numeric_limits<float>::quiet_NaN(), 16777216.0F};
  EXPECT_THAT(write_ray_set(dir / "a", set, "mcpl"), ElementsAre(HasSubstr("3 user flags")));
  EXPECT_THAT(write_ray_set(dir / "a", random_ray_set(2, 2), "mcpl"),
              AllOf(Contains(HasSubstr("555 nm")), Contains(HasSubstr("lumens"))));
  std::string bytes = written(full_mcpl_set(4));
  bytes = patched(bytes, bytes.size() - 4, std::uint32_t{16777217});
  put_bytes(dir / "a", bytes);
  std::vector<std::string> warnings;
  read_ray_set(dir / "a", {}, no_progress(), &warnings);
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("ray 3"), HasSubstr("16777217"))));
  EXPECT_THROW(write_ray_set(dir / "a", set, "mcpl", {.length_unit = "inch"}), UsageError);
}

TEST(Mcpl, AHeaderThatDoesNotAddUpIsNamedByItsByte) {
  const TempDir dir;
  const std::string good = written(full_mcpl_set(3));
  const auto refused = [&](const std::string& bytes) {
    put_bytes(dir / "a", bytes);
    return message_of<InputError>([&] { read_ray_set(dir / "a", {.format = "mcpl"}); });
  };
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused(patched(good, 4, '9')), AllOf(HasSubstr("byte 4: version '903'"), HasSubstr("003")));
  EXPECT_THAT(refused(patched(good, 7, 'B')), AllOf(HasSubstr("byte 7"), HasSubstr("little-endian")));
  EXPECT_THAT(refused(patched(good, 0, 'X')), HasSubstr("byte 0: 'MCPL' expected"));
  for (const std::size_t flag :
       {At::user_flags, At::polarisation, At::single_precision, At::universal_weight})
    EXPECT_THAT(refused(patched(good, flag, std::uint32_t{7})),
                AllOf(HasSubstr(fmt::format("byte {}", flag)), HasSubstr("7 found, 0 or 1 expected")));
  EXPECT_THAT(refused(patched(good, At::pdg_code, 2112)), HasSubstr("byte 36: PDG code 2112"));
  EXPECT_THAT(refused(patched(good, At::particle_size, 90)), HasSubstr("byte 40: 90 bytes per particle"));
  EXPECT_THAT(refused(patched(good, At::particles, std::uint64_t{1} << 63)),
              AllOf(HasSubstr("byte 8"), HasSubstr("3 whole rays")));
  EXPECT_THAT(refused(patched(good, At::comments, 0xFFFFFFFFU)), HasSubstr("expected"));
  EXPECT_THAT(refused(patched(good, At::size, 0xFFFFFFF0U)),
              AllOf(HasSubstr("byte 48: the source's name of 4294967280 bytes expected")));
  // One weight for all needs 8 bytes more of header and 8 less of each particle.
  std::string one = patched(patched(good, At::universal_weight, 1), At::particle_size, 84);
  one.insert(At::size, 8, '\0');
  EXPECT_THAT(refused(patched(one, At::size, nan)), HasSubstr("byte 48: weight nan of all particles"));
}

TEST(Mcpl, AFileThatWasNotClosedIsSalvaged) {
  const TempDir dir;
  put_bytes(dir / "a", patched(written(full_mcpl_set(3)), At::particles, std::uint64_t{0}) + "rest");
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(dir / "a"); }),
              AllOf(HasSubstr("byte 8: 0 particles found before 3 whole ones"), HasSubstr("expected")));
  EXPECT_EQ(read_ray_set(dir / "a", {.salvage = true}).rays.size(), 3u);
}

TEST(Mcpl, PackedFilesAreReadAndTheirDamageIsNamed) {
  const TempDir dir;
  const RaySet set = full_mcpl_set(100);
  const std::string plain = written(set), packed = gzipped(plain);
  put_bytes(dir / "plain", plain);
  const RaySet expected = read_ray_set(dir / "plain");
  put_bytes(dir / "a", packed);
  EXPECT_EQ(detect_ray_format(dir / "a"), "mcpl");
  EXPECT_EQ(read_ray_set(dir / "a"), expected);
  // Two members, as `cat a.gz b.gz` joins them.
  put_bytes(dir / "a", gzipped(plain.substr(0, 1000)) + gzipped(plain.substr(1000)));
  EXPECT_EQ(read_ray_set(dir / "a"), expected);
  // The checksum at the end.
  put_bytes(dir / "a", patched(packed, packed.size() - 8, '\x55'));
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(dir / "a"); }), HasSubstr("gzip"));
  EXPECT_EQ(read_ray_set(dir / "a", {.salvage = true}).rays, expected.rays);
  put_bytes(dir / "a", gzipped(plain + "x"));
  std::vector<std::string> warnings;
  read_ray_set(dir / "a", {}, no_progress(), &warnings);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("after the last particle")));
  // A count that no file of this size can hold is refused before memory is taken for it.
  put_bytes(dir / "a", gzipped(patched(plain, At::particles, std::uint64_t{1} << 60)));
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(dir / "a"); }), HasSubstr("byte 8"));
}

TEST(McplFuzz, EveryTruncationNamesFilePlaceFoundAndExpected) {
  const TempDir dir;
  const std::string plain = written(full_mcpl_set(3)), packed = gzipped(plain);
  for (const std::string& whole : {plain, packed}) {
    for (std::size_t size = 4; size < whole.size(); ++size) {
      put_bytes(dir / "a", std::string_view(whole).substr(0, size));
      EXPECT_THAT(
          message_of<InputError>([&] { read_ray_set(dir / "a", {.format = "mcpl"}); }),
          AllOf(HasSubstr((dir / "a").string() + ": byte "), HasSubstr("expected"), Not(HasSubstr("\n"))))
          << size;
      message_of<InputError>(
          [&] { EXPECT_LE(read_ray_set(dir / "a", {.salvage = true, .format = "mcpl"}).rays.size(), 3u); });
    }
  }
}

TEST(Mcpl, DebiansMcpltoolReadsTheFilesWrittenHere) {
  if (std::system("mcpltool --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "mcpltool is not installed (Debian package mcpl)";
  const TempDir dir;
  const RaySet set = full_mcpl_set(500);
  write_ray_set(dir / "a.mcpl", set, "mcpl");
  const std::string call =
      fmt::format("mcpltool -t '{}' '{}' >/dev/null", (dir / "a.mcpl").string(), (dir / "t").string());
  ASSERT_EQ(std::system(call.c_str()), 0);
  std::ifstream text(dir / "t");
  std::string line;
  while (std::getline(text, line) && !line.starts_with("index")) {
  }
  for (std::size_t i = 0; i < 500; ++i) {
    double index = -1.0, code = 0.0, energy_mev = 0.0, time = 1.0, weight = 0.0;
    Vec3 x, k, polarisation;
    std::string flags;
    text >> index >> code >> energy_mev >> x.x >> x.y >> x.z >> k.x >> k.y >> k.z >> time >> weight >>
        polarisation.x >> polarisation.y >> polarisation.z >> flags;
    ASSERT_TRUE(text) << i;
    EXPECT_EQ(index, static_cast<double>(i));
    EXPECT_EQ(code, 22.0);
    EXPECT_EQ(time, 0.0);
    EXPECT_NEAR(length(10.0 * x - set.rays.origin_mm(i)), 0.0, 1e-6);
    EXPECT_NEAR(length(k - Vec3(set.rays.direction(i))), 0.0, 4e-7);
    EXPECT_NEAR(energy_mev * 1e6 * static_cast<double>(set.rays.extra[0][i]) / 1239.84198, 1.0, 1e-8);
    EXPECT_NEAR(weight * energy_mev * 1.602176634e-13 / static_cast<double>(set.rays.weight[i]), 1.0, 1e-12);
    EXPECT_EQ(std::stoul(flags, nullptr, 16), 70000 * i);
  }
}

}  // namespace
}  // namespace lucerna
