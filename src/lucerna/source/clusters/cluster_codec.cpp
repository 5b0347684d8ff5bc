// SPDX-License-Identifier: Apache-2.0
// The sections of a model of clusters: docs/reference/nfl.md, "Method CLUS".
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna {

namespace {

constexpr NflTag kSurface{'S', 'U', 'R', 'F'}, kPoints{'V', 'E', 'R', 'T'}, kElements{'E', 'L', 'E', 'M'},
    kTrees{'T', 'R', 'E', 'E'}, kLevels{'L', 'E', 'V', 'L'};
constexpr std::uint64_t kMaxClusters = 1u << 20;

void write_vector(NflWriter& w, const Vec3& v) {
  for (const double x : {v.x, v.y, v.z}) w.f64(x);
}

Vec3 read_vector(NflReader& r) {
  const double x = r.f64(), y = r.f64(), z = r.f64();
  return {x, y, z};
}

std::string encode_surface(const ClusterData& d) {
  NflWriter w;
  w.u8(static_cast<std::uint8_t>(d.surface.kind));
  const Frame& f = d.surface.world_from_surface;
  for (const Vec3& v : {f.ex(), f.ey(), f.ez(), f.origin_mm()}) write_vector(w, v);
  w.f64(d.surface.radius_mm);
  for (const Vec3& v : {d.surface.half_size_mm, d.surface.centre_mm, d.low_mm, d.step_mm}) write_vector(w, v);
  return w.take();
}

void decode_surface(NflReader r, ClusterData& d) {
  const std::uint8_t kind = r.u8();
  r.expect(kind <= static_cast<std::uint8_t>(MeshSurfaceKind::hull), "a surface of no known kind");
  d.surface.kind = static_cast<MeshSurfaceKind>(kind);
  const Vec3 ex = read_vector(r), ey = read_vector(r), ez = read_vector(r), origin = read_vector(r);
  const double off = length(cross(ex, ey) - ez) + std::abs(length(ex) - 1.0) + std::abs(length(ey) - 1.0);
  r.expect(off < 1e-6, "a frame that is not orthonormal");
  d.surface.world_from_surface = Frame(ex, ey, ez, origin);
  d.surface.radius_mm = r.f64();
  d.surface.half_size_mm = read_vector(r);
  d.surface.centre_mm = read_vector(r);
  d.low_mm = read_vector(r);
  d.step_mm = read_vector(r);
  const Vec3& h = d.surface.half_size_mm;
  const bool round = d.surface.kind == MeshSurfaceKind::sphere || d.surface.kind == MeshSurfaceKind::cylinder;
  r.expect(!round || d.surface.radius_mm > 0.0, "a radius that is not > 0");
  r.expect(d.surface.kind != MeshSurfaceKind::cylinder || h.z > 0.0, "a length that is not > 0");
  r.expect(d.surface.kind != MeshSurfaceKind::box || (h.x > 0.0 && h.y > 0.0 && h.z > 0.0),
           "a box without inside");
  // Squares and cubes of lengths must stay numbers.
  for (const Vec3& v :
       {origin, h, d.surface.centre_mm, d.low_mm, 65536.0 * d.step_mm, Vec3{d.surface.radius_mm, 0.0, 0.0}}) {
    r.expect(length(v) < 1e30, "a length beyond reason");
  }
  r.finish();
}

/// Low bytes of x, high bytes of x, the same of y and z and of the density: runs that zstd finds.
std::string encode_points(const ClusterData& d) {
  NflWriter w;
  w.varint(d.clusters());
  const auto column = [&](const auto& value) {
    for (const int shift : {0, 8}) {
      for (std::size_t v = 0; v < d.clusters(); ++v) w.u8(static_cast<std::uint8_t>(value(v) >> shift));
    }
  };
  for (std::size_t k = 0; k < 3; ++k) column([&](std::size_t v) { return d.place[v][k]; });
  column([&](std::size_t v) { return d.density[v]; });
  return w.take();
}

void decode_points(NflReader r, ClusterData& d) {
  const std::uint64_t n = r.varint();
  r.expect(n >= 1 && n <= kMaxClusters && n == r.left() / 8 && r.left() % 8 == 0,
           "a number of clusters that the section does not hold");
  d.place.resize(n);
  d.density.resize(n);
  const auto column = [&](const auto& set) {
    for (const int shift : {0, 8}) {
      for (std::size_t v = 0; v < n; ++v) set(v, static_cast<std::uint16_t>(r.u8() << shift));
    }
  };
  for (std::size_t k = 0; k < 3; ++k) {
    column([&](std::size_t v, std::uint16_t x) {
      d.place[v][k] = static_cast<std::uint16_t>(d.place[v][k] | x);
    });
  }
  column(
      [&](std::size_t v, std::uint16_t x) { d.density[v] = static_cast<std::uint16_t>(d.density[v] | x); });
  r.finish();
}

std::string encode_elements(const ClusterData& d) {
  NflWriter w;
  w.varint(d.elements.size());
  std::int64_t last = 0;
  for (const Triangle& e : d.elements) {
    w.signed_varint(static_cast<std::int64_t>(e[0]) - last);
    w.signed_varint(static_cast<std::int64_t>(e[1]) - static_cast<std::int64_t>(e[0]));
    w.signed_varint(static_cast<std::int64_t>(e[2]) - static_cast<std::int64_t>(e[1]));
    last = e[0];
  }
  return w.take();
}

void decode_elements(NflReader r, ClusterData& d) {
  const std::uint64_t n = r.varint();
  r.expect(n >= 1 && n <= r.left() / 3, "a number of elements that the section does not hold");
  // A mesh over K points has fewer than 2 K triangles; K points may stand alone beside it.
  r.expect(n <= 3 * static_cast<std::uint64_t>(d.clusters()) + 8,
           "more elements than a mesh of the points has");
  std::int64_t last = 0;
  const auto limit = static_cast<std::int64_t>(d.clusters());
  for (std::uint64_t i = 0; i < n; ++i) {
    Triangle e{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t delta = r.signed_varint();
      r.expect(delta > -limit && delta < limit && last + delta >= 0 && last + delta < limit,
               "an element of a cluster that does not exist");
      last += delta;
      e[k] = static_cast<std::uint32_t>(last);
    }
    last = e[0];
    const bool point = e[0] == e[1] && e[1] == e[2], segment = e[0] != e[1] && e[1] == e[2];
    const bool triangle = e[0] != e[1] && e[1] != e[2] && e[0] != e[2];
    r.expect(point || segment || triangle, "an element that is no point, segment or triangle");
    r.expect(!triangle || d.surface.has_area(), "a triangle on a surface without area");
    d.elements.push_back(e);
  }
  r.finish();
}

/// A bit for every triangle in the order of a depth-first visit of the octants: 1 = split. None at the finest
/// level.
class BitWriter {
 public:
  void bit(bool one) {
    byte_ = static_cast<std::uint8_t>(byte_ | (one ? 1u : 0u) << count_);
    if (++count_ == 8) flush();
  }
  std::string take() {
    if (count_ > 0) flush();
    return out_.take();
  }

 private:
  void flush() {
    out_.u8(byte_);
    byte_ = 0;
    count_ = 0;
  }
  NflWriter out_;
  std::uint8_t byte_ = 0;
  int count_ = 0;
};

std::string encode_trees(const ClusterData& d) {
  BitWriter bits;
  for (std::size_t v = 0; v < d.clusters(); ++v) {
    std::uint32_t done = 0;  // codes covered so far
    for (std::uint32_t i = d.leaf_begin[v]; i < d.leaf_begin[v + 1]; ++i) {
      const ClusterLeaf& leaf = d.leaf[i];
      // Splits between the coarsest triangle that begins here and the leaf.
      int top = leaf.depth;
      while (top > 0 && leaf.code % direction_span(top - 1) == 0) --top;
      for (int depth = top; depth < leaf.depth; ++depth) bits.bit(true);
      if (leaf.depth < kDirectionDepth) bits.bit(false);
      done = leaf.code + direction_span(leaf.depth);
    }
    LUCERNA_CHECK(done == kDirectionCodes, "leaves of cluster {} end at {}", v, done);
  }
  return bits.take();
}

/// `max` leaves have levels: more are refused before they take memory.
void decode_trees(NflReader r, std::size_t max, ClusterData& d) {
  std::uint32_t byte = 0;
  int left = 0;
  const auto bit = [&] {
    if (left == 0) {
      byte = r.u8();
      left = 8;
    }
    const bool one = byte & 1u;
    byte >>= 1;
    --left;
    return one;
  };
  d.leaf_begin.assign(1, 0);
  for (std::size_t v = 0; v < d.clusters(); ++v) {
    for (std::uint32_t code = 0; code < kDirectionCodes;) {
      // The coarsest triangle that begins at this code.
      int depth = 0;
      while (code % direction_span(depth) != 0) ++depth;
      while (depth < kDirectionDepth && bit()) ++depth;
      r.expect(d.leaf.size() < max, "more leaves than levels");
      d.leaf.push_back({code, static_cast<std::uint8_t>(depth), 0});
      code += direction_span(depth);
    }
    d.leaf_begin.push_back(static_cast<std::uint32_t>(d.leaf.size()));
  }
  r.expect(byte == 0, "bits that belong to no triangle");
  r.finish();
}

void decode_levels(NflReader r, ClusterData& d) {
  r.expect(r.left() == d.leaf.size(), "a number of levels that is not that of the leaves");
  for (std::size_t v = 0; v < d.clusters(); ++v) {
    std::uint8_t max = 0;
    for (std::uint32_t i = d.leaf_begin[v]; i < d.leaf_begin[v + 1]; ++i) {
      d.leaf[i].level = r.u8();
      max = std::max(max, d.leaf[i].level);
    }
    r.expect(max > 0, "a cluster without directions");
  }
  r.finish();
}

}  // namespace

NflFile encode_clusters(const ClusterData& d) {
  NflFile file{kClusterMethod, d.flux, d.flux_unit, d.training_rays, {}};
  file.add(kSurface, encode_surface(d));
  file.add(kPoints, encode_points(d));
  file.add(kElements, encode_elements(d));
  file.add(kTrees, encode_trees(d));
  NflWriter levels;
  for (const ClusterLeaf& leaf : d.leaf) levels.u8(leaf.level);
  file.add(kLevels, levels.take());
  return file;
}

ClusterData decode_clusters(const NflFile& file, std::string_view name) {
  ClusterData d;
  d.flux = file.flux;
  d.flux_unit = file.flux_unit;
  d.training_rays = file.training_rays;
  decode_surface(NflReader(file, kSurface, name), d);
  decode_points(NflReader(file, kPoints, name), d);
  decode_elements(NflReader(file, kElements, name), d);
  NflReader levels(file, kLevels, name);
  decode_trees(NflReader(file, kTrees, name), levels.left(), d);
  decode_levels(levels, d);
  double total = 0.0;
  for (const MeshPiece& piece : mesh_pieces(d)) {
    total += piece.measure * (piece.density[0] + piece.density[1] + piece.density[2]);
  }
  if (!std::isfinite(total) || total <= 0.0) throw_input_error(name, "", "no element of the mesh shines");
  return d;
}

}  // namespace lucerna
