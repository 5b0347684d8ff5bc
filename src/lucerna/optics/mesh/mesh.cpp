// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/geometry.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxMeshBytes = std::uint64_t{2} << 30;

/// Words of a text, line by line.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }
  std::string_view word() {
    const std::size_t begin = std::min(line_.find_first_not_of(" \t\r"), line_.size());
    line_.remove_prefix(begin);
    const std::size_t end = std::min(line_.find_first_of(" \t\r"), line_.size());
    const std::string_view w = line_.substr(0, end);
    line_.remove_prefix(end);
    return w;
  }
  Vec3 point() {
    Vec3 p;
    for (double* const x : {&p.x, &p.y, &p.z}) {
      const std::string_view w = word();
      const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), *x);
      if (error != std::errc() || end != w.data() + w.size() || !std::isfinite(*x)) {
        fail("found '{}', expected a finite number", w);
      }
    }
    return p;
  }
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("line {}", number_), text, std::forward<Args>(args)...);
  }

 private:
  std::string_view rest_, line_;
  std::string file_;
  std::size_t number_ = 0;
};

/// Adds triangles by their corners; equal corners become one vertex.
class Weld {
 public:
  void corner(const Vec3& p) {
    const auto [place, fresh] =
        index_.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.vertices_mm.size()));
    if (fresh) mesh.vertices_mm.push_back(p);
    corners_[used_++] = place->second;
    if (used_ == 3) {
      mesh.triangles.push_back(corners_);
      used_ = 0;
    }
  }
  bool whole() const { return used_ == 0; }
  Mesh mesh;

 private:
  std::map<std::array<double, 3>, std::uint32_t> index_;
  std::array<std::uint32_t, 3> corners_{};
  std::size_t used_ = 0;
};

Mesh read_binary_stl(const std::string& bytes, const std::string& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  Weld weld;
  for (std::size_t i = 0; i < count; ++i) {
    float v[9];
    std::memcpy(v, bytes.data() + 84 + 50 * i + 12, sizeof v);
    for (std::size_t k = 0; k < 9; k += 3) {
      const Vec3 p{v[k], v[k + 1], v[k + 2]};
      if (!is_finite(p))
        throw_input_error(file, fmt::format("byte {}", 84 + 50 * i + 12 + 4 * k),
                          "a coordinate is not finite");
      weld.corner(p);
    }
  }
  return std::move(weld.mesh);
}

Mesh read_text_stl(const std::string& text, const std::string& file) {
  Lines lines(text, file);
  Weld weld;
  while (lines.next()) {
    const std::string_view word = lines.word();
    if (word == "vertex") weld.corner(lines.point());
    if (word == "endfacet" && !weld.whole()) lines.fail("the facet has not three corners");
  }
  if (!weld.whole()) lines.fail("the file ends within a facet");
  return std::move(weld.mesh);
}

}  // namespace

Mesh read_stl(const std::filesystem::path& path) {
  std::string bytes = read_file(path, kMaxMeshBytes);
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, sizeof count);
  // A binary file's size follows from its count; many begin with "solid" all the same.
  const bool binary = bytes.size() >= 84 && bytes.size() == 84 + std::uint64_t{50} * count;
  if (!binary) {  // some programs write SOLID, FACET, ...
    for (char& c : bytes) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (!binary && !std::string_view(bytes).starts_with("solid")) {
    throw_input_error(path.string(), "byte 80", "{} bytes do not hold the {} triangles that are announced",
                      bytes.size(), count);
  }
  Mesh mesh = binary ? read_binary_stl(bytes, path.string()) : read_text_stl(bytes, path.string());
  if (mesh.triangles.empty()) throw_input_error(path.string(), "", "holds no triangle");
  return mesh;
}

Mesh read_obj(const std::filesystem::path& path) {
  const std::string text = read_file(path, kMaxMeshBytes);
  Lines lines(text, path.string());
  Mesh mesh;
  while (lines.next()) {
    const std::string_view kind = lines.word();
    if (kind == "v") mesh.vertices_mm.push_back(lines.point());
    if (kind != "f") continue;
    std::vector<std::uint32_t> corners;
    for (std::string_view w = lines.word(); !w.empty(); w = lines.word()) {
      const std::string_view number = w.substr(0, w.find('/'));
      long long i = 0;
      const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), i);
      const auto n = static_cast<long long>(mesh.vertices_mm.size());
      if (i < 0) i += n + 1;
      if (error != std::errc() || end != number.data() + number.size() || i < 1 || i > n) {
        lines.fail("found '{}', expected a vertex from 1 to {}", w, n);
      }
      corners.push_back(static_cast<std::uint32_t>(i - 1));
    }
    if (corners.size() < 3) lines.fail("a face has {} corners, expected at least 3", corners.size());
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
  if (mesh.triangles.empty()) throw_input_error(path.string(), "", "holds no triangle");
  // Exporters repeat vertices along seams of texture; to a mirror they are one.
  Weld weld;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t k : triangle) weld.corner(mesh.vertices_mm[k]);
  }
  return std::move(weld.mesh);
}

Mesh read_mesh(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  if (ending == ".stl") return read_stl(path);
  if (ending == ".obj") return read_obj(path);
  throw_input_error(path.string(), "", "ends in '{}', expected .stl or .obj", ending);
}

std::vector<Vec3> corner_normals(const Mesh& mesh, double crease_deg) {
  const double min_cosine = std::cos(radians(crease_deg));
  const std::size_t n = mesh.triangles.size();
  std::vector<Vec3> flat(n);
  std::vector<std::vector<std::size_t>> corners_at(mesh.vertices_mm.size());
  std::vector<double> angle(3 * n);
  for (std::size_t t = 0; t < n; ++t) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = mesh.vertices_mm[mesh.triangles[t][k]];
      corners_at[mesh.triangles[t][k]].push_back(3 * t + k);
    }
    const Vec3 across = cross(p[1] - p[0], p[2] - p[0]);
    flat[t] = length(across) > 0.0 ? Direction::from(across).vec() : Vec3{0.0, 0.0, 1.0};
    if (length(across) == 0.0) continue;  // its corners weigh nothing
    for (std::size_t k = 0; k < 3; ++k) {
      angle[3 * t + k] =
          angle_between(Direction::from(p[(k + 1) % 3] - p[k]), Direction::from(p[(k + 2) % 3] - p[k]));
    }
  }
  std::vector<Vec3> normals(3 * n);
  for (std::size_t c = 0; c < 3 * n; ++c) {
    const Vec3& own = flat[c / 3];
    Vec3 sum{};
    for (const std::size_t other : corners_at[mesh.triangles[c / 3][c % 3]]) {
      if (dot(own, flat[other / 3]) >= min_cosine) sum = sum + angle[other] * flat[other / 3];
    }
    normals[c] = length(sum) > 0.0 ? Direction::from(sum).vec() : own;
  }
  return normals;
}

std::size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax({t[k], t[(k + 1) % 3]})];
  }
  return static_cast<std::size_t>(
      std::count_if(uses.begin(), uses.end(), [](const auto& e) { return e.second != 2; }));
}

}  // namespace lucerna
