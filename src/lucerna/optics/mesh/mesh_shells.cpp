// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/mesh_shells.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace lucerna {

std::vector<Mesh> shells_of(const Mesh& mesh) {
  // By places: files may repeat corners.
  std::map<std::array<double, 3>, std::size_t> number;
  std::vector<std::size_t> place, root;
  for (const Vec3& v : mesh.vertices_mm) {
    const auto [at, is_new] = number.insert({{v.x, v.y, v.z}, root.size()});
    if (is_new) root.push_back(root.size());
    place.push_back(at->second);
  }
  const auto root_of = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& t : mesh.triangles) {
    for (const std::size_t k : {1U, 2U}) root[root_of(place[t[k]])] = root_of(place[t[0]]);
  }
  std::map<std::size_t, Mesh> shells;
  for (const auto& t : mesh.triangles) {
    Mesh& shell = shells[root_of(place[t[0]])];
    const auto first = static_cast<std::uint32_t>(shell.vertices_mm.size());
    for (const std::uint32_t k : t) shell.vertices_mm.push_back(mesh.vertices_mm[k]);
    shell.triangles.push_back({first, first + 1, first + 2});
  }
  std::vector<Mesh> out;
  for (auto& [_, shell] : shells) out.push_back(std::move(shell));
  return out;
}

double signed_volume(const Mesh& mesh) {
  double sum = 0.0;
  const Vec3 from = mesh.vertices_mm.front();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]] - from, b = mesh.vertices_mm[t[1]] - from;
    sum += dot(a, cross(b, mesh.vertices_mm[t[2]] - from));
  }
  return sum;
}

}  // namespace lucerna
