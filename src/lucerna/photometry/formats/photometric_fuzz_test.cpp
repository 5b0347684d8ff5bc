// SPDX-License-Identifier: Apache-2.0
// Damaged copies of every file in tests/data/photometry: each is read as a sound grid or refused with
// InputError.
#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/random.h"
#include "tests/support/paths.h"

namespace lucerna {
namespace {

void expect_read_or_refused(const std::string& bytes) {
  for (const auto& read : {read_ies, read_ldt}) {
    try {
      EXPECT_EQ(grid_fault(read(bytes, "fuzz", {}).distribution), "");
    } catch (const InputError&) {
      continue;
    }
  }
}

TEST(PhotometricReaderFuzz, DamagedFilesAreReadOrRefused) {
  constexpr std::string_view kBytes = "0123456789.,-+eE \n\r\t[]=9\xff";
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::source_dir() / "tests/data/photometry")) {
    const std::string original = read_file(entry.path(), 1 << 20);
    expect_read_or_refused(original);
    for (std::uint64_t variant = 0; variant < 150; ++variant) {
      Rng rng(++files, variant);
      std::string bytes = original;
      for (std::uint32_t change = 0; change <= variant % 4; ++change) {
        if (bytes.empty()) break;
        const std::size_t at = rng.bits() % bytes.size();
        switch (rng.bits() % 3) {
          case 0:
            bytes[at] = kBytes[rng.bits() % kBytes.size()];
            break;
          case 1:
            bytes.erase(at, 1 + rng.bits() % 30);
            break;
          default:
            bytes.insert(at, 1 + rng.bits() % 3, kBytes[rng.bits() % kBytes.size()]);
        }
      }
      expect_read_or_refused(bytes);
    }
  }
  EXPECT_GT(files, 40u);
}

}  // namespace
}  // namespace lucerna
