// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/rays.h"
#include "tests/support/random_direction.h"

namespace lucerna::test {

/// `n` rays over all directions, starts in a box of some mm, unequal weights, extra columns of plausible
/// size; the same for the same seed.
inline RaySet random_ray_set(std::size_t n, std::uint64_t seed, std::vector<ColumnSpec> columns = {}) {
  RaySet set;
  set.header.columns = std::move(columns);
  set.header.set_flux(337.5);
  RayBlock& b = set.rays;
  b.resize(n, set.header.columns.size());
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    const Direction direction = random_direction(rng);
    const Vec3 start{6.0 * rng.uniform() - 3.0, 4.0 * rng.uniform(), rng.uniform() - 20.0};
    b.set(i, {start, direction});
    b.weight[i] = static_cast<float>(rng.uniform() + 0.01);
    for (std::size_t c = 0; c < b.extra.size(); ++c) {
      const bool wavelength = set.header.columns[c].kind == ColumnKind::wavelength_nm;
      b.extra[c][i] = static_cast<float>(wavelength ? 380.0 + 400.0 * rng.uniform() : rng.uniform());
    }
  }
  return set;
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void put_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// `bytes` with `value` put at `offset`.
template <class T>
std::string patched(std::string bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
  return bytes;
}

/// The text of the exception of type E that `call` throws; "no exception" if none.
template <class E, class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const E& error) {
    return error.what();
  }
  return "no exception";
}

}  // namespace lucerna::test
