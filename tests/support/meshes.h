// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>

#include "lucerna/mesh.h"
#include "lucerna/random.h"

namespace lucerna::test {

/// A closed globe of `n` zones of 2 n sectors.
inline std::shared_ptr<const Mesh> globe(std::uint32_t n, double radius) {
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices_mm = {{0, 0, radius}, {0, 0, -radius}};
  const std::uint32_t around = 2 * n;
  for (std::uint32_t i = 1; i < n; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = std::numbers::pi * i / n, b = 2.0 * std::numbers::pi * j / around;
      mesh->vertices_mm.push_back(
          {radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b), radius * std::cos(a)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 2 + (i - 1) * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh->triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh->triangles.push_back({1, at(n - 1, j + 1), at(n - 1, j)});
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
      mesh->triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh->triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A closed box from -half to half.
inline std::shared_ptr<const Mesh> box_mesh(const Vec3& half) {
  auto mesh = std::make_shared<Mesh>();
  for (int i = 0; i < 8; ++i) {
    mesh->vertices_mm.push_back(
        {(i & 1) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y, (i & 4) != 0 ? half.z : -half.z});
  }
  mesh->triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// An open sheet of n x n squares over |x|, |y| < half: z = bend (x^2 + y^2) / 2, with waves of `wave_mm`.
inline std::shared_ptr<const Mesh> sheet(std::uint32_t n, double half, double bend, double wave_mm) {
  auto mesh = std::make_shared<Mesh>();
  for (std::uint32_t i = 0; i < (n + 1) * (n + 1); ++i) {
    const double x = 2.0 * half * (i % (n + 1)) / n - half, y = 2.0 * half * (i / (n + 1)) / n - half;
    mesh->vertices_mm.push_back(
        {x, y, 0.5 * bend * (x * x + y * y) + wave_mm * std::sin(0.7 * x) * std::cos(0.9 * y)});
    if (i % (n + 1) == n || i / (n + 1) == n) continue;
    const std::uint32_t above = i + n + 1;
    mesh->triangles.push_back({i, i + 1, above + 1});
    mesh->triangles.push_back({i, above + 1, above});
  }
  return mesh;
}

/// Triangles anywhere in |x|, |y|, |z| < 50, of sizes from 0.01 to 30 mm; some are lines or points.
inline std::shared_ptr<const Mesh> loose_triangles(std::uint32_t n, std::uint64_t seed) {
  auto mesh = std::make_shared<Mesh>();
  Rng rng(seed, 0);
  const auto within = [&](double half) { return half * (2.0 * rng.uniform() - 1.0); };
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 middle{within(50.0), within(50.0), within(50.0)};
    const double size = 0.01 * std::pow(3000.0, rng.uniform());
    for (int k = 0; k < 3; ++k)
      mesh->vertices_mm.push_back(middle + Vec3{within(size), within(size), within(size)});
    const std::uint32_t a = 3 * i;
    if (i % 50 == 7) {
      mesh->triangles.push_back({a, a + 1, a});
    } else {
      mesh->triangles.push_back({a, a + 1, a + 2});
    }
  }
  return mesh;
}

}  // namespace lucerna::test
