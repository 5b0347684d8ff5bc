// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "lucerna/core/cpu/huge_pages.h"
#include "lucerna/core/io/error.h"
#include "lucerna/rays.h"

namespace lucerna {

namespace {

/// Rays are drawn from all over a set, in short runs.
void make_room(std::vector<float>& array, std::size_t n) {
  if (n <= array.capacity()) return;
  array.reserve(n);
  advise_huge_pages(array.data() + array.size(), (n - array.size()) * sizeof(float));
}

/// Sets below this are copied in no time.
constexpr std::size_t kFewRays = std::size_t{1} << 14;
/// Memory that is freed leaves holes, which the next columns fall into.
constexpr std::size_t kMostCandidates = 12;

std::uintptr_t bytes_between(const std::vector<float>& a, const std::vector<float>& b) {
  return reinterpret_cast<std::uintptr_t>(b.data()) - reinterpret_cast<std::uintptr_t>(a.data());
}

/// Room for three empty columns, equally far apart if the allocator has such places: then an array of vectors
/// can be laid across them without a copy. What is allocated in turn is, but for holes; room that is not
/// touched costs next to nothing.
void look_for_even_room(std::vector<float>& x, std::vector<float>& y, std::vector<float>& z, std::size_t n) {
  const bool is_new = x.capacity() == 0 && y.capacity() == 0 && z.capacity() == 0;
  if (n < kFewRays || !is_new) return;
  std::vector<std::vector<float>> rooms(2);
  for (auto& room : rooms) room.reserve(n);
  while (rooms.size() < kMostCandidates) {
    auto& last = rooms.emplace_back();
    last.reserve(n);
    for (std::size_t j = rooms.size() - 2; j > 0; --j) {
      for (std::size_t i = j; i-- > 0;) {
        if (bytes_between(rooms[i], rooms[j]) != bytes_between(rooms[j], last)) continue;
        x = std::move(rooms[i]);
        y = std::move(rooms[j]);
        z = std::move(last);
        for (auto* column : {&x, &y, &z}) advise_huge_pages(column->data(), n * sizeof(float));
        return;
      }
    }
  }
}

/// Where a process may not reserve more than it uses, the columns lie as they fall.
void make_even_room(std::vector<float>& x, std::vector<float>& y, std::vector<float>& z, std::size_t n) {
  try {
    look_for_even_room(x, y, z, n);
  } catch (const std::bad_alloc&) {
  }
}

}  // namespace

void RayBlock::resize(std::size_t n, std::size_t columns) {
  make_even_room(x_mm, y_mm, z_mm, n);
  make_even_room(kx, ky, kz, n);
  for (auto* array : {&x_mm, &y_mm, &z_mm, &kx, &ky, &kz, &weight}) {
    if (array->empty()) make_room(*array, n);
    array->resize(n);
  }
  extra.resize(columns);
  for (auto& column : extra) column.resize(n);
}

void RayBlock::reserve(std::size_t n) {
  make_even_room(x_mm, y_mm, z_mm, n);
  make_even_room(kx, ky, kz, n);
  for (auto* array : {&x_mm, &y_mm, &z_mm, &kx, &ky, &kz, &weight}) make_room(*array, n);
  for (auto& column : extra) column.reserve(n);
}

void RayBlock::append(const RayBlock& other, std::size_t i) {
  LUCERNA_CHECK(extra.size() == other.extra.size() && i < other.size(), "columns {} and {}, ray {} of {}",
                extra.size(), other.extra.size(), i, other.size());
  x_mm.push_back(other.x_mm[i]);
  y_mm.push_back(other.y_mm[i]);
  z_mm.push_back(other.z_mm[i]);
  kx.push_back(other.kx[i]);
  ky.push_back(other.ky[i]);
  kz.push_back(other.kz[i]);
  weight.push_back(other.weight[i]);
  for (std::size_t c = 0; c < extra.size(); ++c) extra[c].push_back(other.extra[c][i]);
}

void RayBlock::append(const RayBlock& other) {
  if (empty() && extra.empty()) extra.resize(other.extra.size());
  LUCERNA_CHECK(extra.size() == other.extra.size(), "columns {} and {}", extra.size(), other.extra.size());
  const auto join = [](std::vector<float>& a, const std::vector<float>& b) {
    a.insert(a.end(), b.begin(), b.end());
  };
  join(x_mm, other.x_mm);
  join(y_mm, other.y_mm);
  join(z_mm, other.z_mm);
  join(kx, other.kx);
  join(ky, other.ky);
  join(kz, other.kz);
  join(weight, other.weight);
  for (std::size_t c = 0; c < extra.size(); ++c) join(extra[c], other.extra[c]);
}

void RayBlock::set(std::size_t i, const Ray& ray) {
  x_mm[i] = static_cast<float>(ray.origin_mm.x);
  y_mm[i] = static_cast<float>(ray.origin_mm.y);
  z_mm[i] = static_cast<float>(ray.origin_mm.z);
  kx[i] = static_cast<float>(ray.direction.x());
  ky[i] = static_cast<float>(ray.direction.y());
  kz[i] = static_cast<float>(ray.direction.z());
}

}  // namespace lucerna
