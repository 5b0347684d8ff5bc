// SPDX-License-Identifier: Apache-2.0
// Any bytes as what a trace leaves behind: its sums, its far field and its planes. Each is read, or
// InputError. The sums lie in a zstd frame, which random bytes hardly ever are: the input is packed into one
// unless it is a whole file. The first byte chooses the reader.
#include <zstd.h>

#include <cstring>
#include <string>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/results/folders/trace_file.h"
#include "lucerna/results/folders/trace_folder.h"

namespace {

constexpr std::string_view kMagic = "LUCTRACE";
constexpr std::uint32_t kVersion = 3;

std::string packed(std::string_view bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), 1));
  std::string file(kMagic);
  file.append(reinterpret_cast<const char*>(&kVersion), sizeof kVersion);
  return file + frame;
}

void read_sums(std::string_view bytes) {
  const std::string all = bytes.starts_with(kMagic) ? std::string(bytes) : packed(bytes);
  const MemoryFile file(reinterpret_cast<const std::uint8_t*>(all.data()), all.size());
  const lucerna::StoredTrace stored = lucerna::read_trace_file(file.path());
  require(stored.result.first_ray < stored.result.last_ray);
}

void read_as(int reader, std::string_view bytes) {
  if (reader == 0) {
    read_sums(bytes);
  } else if (reader == 1) {
    const auto table = lucerna::far_field_table(bytes, "fuzz");
    require(!table.distribution.cd.empty());
  } else {
    const auto table = lucerna::plane_table(bytes, "fuzz");
    require(table.value.size() == table.x_mm.size() * table.y_mm.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    read_as(data[0] % 3, {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
  return 0;
}
