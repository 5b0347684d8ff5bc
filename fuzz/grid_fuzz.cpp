// SPDX-License-Identifier: Apache-2.0
// Any bytes as a table of numbers, a height map and a map of illuminance in each of their formats: finite
// numbers or InputError. The first byte chooses the reader.
#include <cmath>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/number_table.h"
#include "lucerna/optics/height_field/height_map.h"
#include "lucerna/photometry/formats/illuminance_map.h"

namespace {

void read_as(int reader, const std::uint8_t* data, std::size_t size) {
  static const char* const kEndings[] = {".csv", ".npy", ".pgm", ".png"};
  if (reader < 4) {
    lucerna::read_height_map(MemoryFile(data, size, kEndings[reader]).path());
  } else if (reader == 4) {
    lucerna::read_illuminance_csv(MemoryFile(data, size).path());
  } else if (reader == 5) {
    lucerna::read_illuminance_png(MemoryFile(data, size).path());
  } else {
    const auto table =
        lucerna::read_number_table(MemoryFile(data, size).path(), lucerna::TableHeader::optional);
    require(table.numbers.size() == table.columns * table.rows);
    for (const double number : table.numbers) require(std::isfinite(number));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    read_as(data[0] % 7, data + 1, size - 1);
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
  return 0;
}
