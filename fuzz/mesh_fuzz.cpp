// SPDX-License-Identifier: Apache-2.0
// Any bytes as an STL and as an OBJ file: a mesh whose triangles have vertices, all finite, or InputError.
#include <cmath>

#include "fuzz/memory_file.h"
#include "lucerna/core/io/error.h"
#include "lucerna/mesh.h"

namespace {

template <class Read>
void expect_mesh(Read read) {
  try {
    const lucerna::Mesh mesh = read();
    require(!mesh.triangles.empty());
    for (const auto& vertex : mesh.vertices_mm) require(is_finite(vertex));
    for (const auto& triangle : mesh.triangles) {
      for (const auto corner : triangle) require(corner < mesh.vertices_mm.size());
    }
    lucerna::open_edges(mesh);
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  expect_mesh([&] { return lucerna::read_stl(file.path()); });
  expect_mesh([&] { return lucerna::read_obj(file.path()); });
  return 0;
}
