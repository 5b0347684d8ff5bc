// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "surface.h"

namespace bench {

namespace {

struct Facet {
  Vec3 normal;
  std::array<Vec3, 3> corner;
};

std::string facet_place(std::size_t k) { return "facet " + std::to_string(k + 1); }

std::string file_bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file, "file", "nothing that can be opened", "an STL file");
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Of an interpolated normal from its facet.
constexpr double kFarthestNormalDeg = 10.0;

std::string shown_point(const Vec3& p) {
  return "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ") mm";
}

constexpr std::size_t kHead = 84, kRecord = 50;

std::vector<Facet> binary_facets(const std::string& file, const std::string& bytes) {
  if (bytes.size() < kHead)
    throw InputError(file, "byte 0", std::to_string(bytes.size()) + " bytes", "an STL header of 84 bytes");
  std::uint32_t n = 0;
  std::memcpy(&n, bytes.data() + 80, 4);
  if (bytes.size() != kHead + std::uint64_t{n} * kRecord)
    throw InputError(file, "byte 80",
                     std::to_string(n) + " facets in " + std::to_string(bytes.size()) + " bytes",
                     std::to_string(kHead + std::uint64_t{n} * kRecord) + " bytes");
  std::vector<Facet> out(n);
  for (std::size_t k = 0; k < n; ++k) {
    float v[12];
    std::memcpy(v, bytes.data() + kHead + k * kRecord, sizeof v);
    const auto vec = [&](std::size_t i) { return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]}; };
    out[k] = {vec(0), {vec(1), vec(2), vec(3)}};
  }
  return out;
}

/// The words of a text STL, with their lines.
class StlWords {
 public:
  StlWords(const std::string& file, const std::string& text) : file_(file) {
    std::istringstream lines(text);
    std::string line, word;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
      std::istringstream words(line);
      while (words >> word) words_.emplace_back(word, number);
    }
  }
  bool next_is(const std::string& word) const { return at_ < words_.size() && words_[at_].first == word; }
  void expect(const std::string& word) {
    if (!next_is(word)) fail(word);
    ++at_;
  }
  Vec3 vec() { return {number(), number(), number()}; }
  bool at_end() const { return at_ == words_.size(); }
  /// `endsolid` may be followed by any words on its line.
  void skip_line() {
    const std::size_t line = words_[at_ - 1].second;
    while (at_ < words_.size() && words_[at_].second == line) ++at_;
  }
  /// `solid` may be followed by any words.
  void skip_to(const std::string& a, const std::string& b) {
    while (at_ < words_.size() && !next_is(a) && !next_is(b)) ++at_;
  }

 private:
  double number() {
    char* end = nullptr;
    const double x = at_ < words_.size() ? std::strtod(words_[at_].first.c_str(), &end) : 0.0;
    if (end == nullptr || *end != '\0') fail("a number");
    ++at_;
    return x;
  }
  [[noreturn]] void fail(const std::string& expected) const {
    const bool over = at_ >= words_.size();
    const std::size_t line = words_.empty() ? 1 : over ? words_.back().second : words_[at_].second;
    throw InputError(file_, "line " + std::to_string(line), over ? "the end of the file" : words_[at_].first,
                     expected);
  }
  std::string file_;
  std::vector<std::pair<std::string, std::size_t>> words_;
  std::size_t at_ = 0;
};

/// The facets of one `solid`.
void add_solid(StlWords& words, std::vector<Facet>& out) {
  while (words.next_is("facet")) {
    Facet f;
    words.expect("facet");
    words.expect("normal");
    f.normal = words.vec();
    words.expect("outer");
    words.expect("loop");
    for (Vec3& corner : f.corner) {
      words.expect("vertex");
      corner = words.vec();
    }
    words.expect("endloop");
    words.expect("endfacet");
    out.push_back(f);
  }
}

std::vector<Facet> text_facets(const std::string& file, const std::string& text) {
  StlWords words(file, text);
  std::vector<Facet> out;
  do {
    words.expect("solid");
    words.skip_to("facet", "endsolid");
    add_solid(words, out);
    words.expect("endsolid");
    words.skip_line();
  } while (!words.at_end());
  return out;
}
bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::vector<Facet> read_facets(const std::string& file) {
  const std::string bytes = file_bytes(file);
  const bool text = bytes.rfind("solid", 0) == 0 && bytes.find("facet") != std::string::npos;
  std::vector<Facet> facets = text ? text_facets(file, bytes) : binary_facets(file, bytes);
  std::vector<Facet> out;
  for (std::size_t k = 0; k < facets.size(); ++k) {
    const Facet& f = facets[k];
    if (!finite(f.corner[0]) || !finite(f.corner[1]) || !finite(f.corner[2]))
      throw InputError(file, facet_place(k), "a corner that is not finite", "finite numbers");
    const Vec3 n = cross(f.corner[1] - f.corner[0], f.corner[2] - f.corner[0]);
    if (finite(f.normal) && dot(f.normal, n) < 0.0)
      throw InputError(file, facet_place(k), "a stored normal against the corners' order",
                       "corners counter-clockwise about the normal");
    if (length(n) > 0.0) out.push_back(f);
  }
  if (out.empty()) throw InputError(file, "file", "no facet with an area", "one or more");
  return out;
}

class StlSurface final : public Surface {
 public:
  StlSurface(const std::string& file, const std::vector<Facet>& facets, const Frame& place,
             double crease_deg) {
    weld(facets, place);
    for (const auto& t : mesh_.triangles) {
      const auto& c = mesh_.corners;
      flat_.push_back(unit(cross(c[t[1]] - c[t[0]], c[t[2]] - c[t[0]])));
    }
    if (crease_deg > 0.0) smooth(std::cos(crease_deg * kDegree));
    for (std::size_t k = 0; k < smooth_.size(); ++k) {
      for (const Vec3& n : smooth_[k]) require_near(file, k, n);
    }
  }

  const Triangles& triangles() const override { return mesh_; }

  bool refine(const Vec3& o, const Vec3& d, const FlatHit& flat, Hit& hit) const override {
    const auto& t = mesh_.triangles[flat.triangle];
    const Vec3& n = flat_[flat.triangle];
    const double across = dot(d, n);
    if (across == 0.0) return false;
    hit.t = dot(mesh_.corners[t[0]] - o, n) / across;
    hit.geometric = hit.normal = n;
    if (!smooth_.empty()) {
      const auto& s = smooth_[flat.triangle];
      hit.normal = unit((1.0 - flat.b1 - flat.b2) * s[0] + flat.b1 * s[1] + flat.b2 * s[2]);
    }
    return true;
  }

 private:
  void weld(const std::vector<Facet>& facets, const Frame& place) {
    std::map<std::array<double, 3>, std::uint32_t> number;
    for (const Facet& f : facets) {
      std::array<std::uint32_t, 3> t{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& p = f.corner[i];
        const auto [at, is_new] =
            number.emplace(std::array{p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh_.corners.size()));
        if (is_new) mesh_.corners.push_back(place.point(p));
        t[i] = at->second;
      }
      mesh_.triangles.push_back(t);
    }
  }
  /// Normals that lean far from a facet are no longer those of any surface near it: such a mesh could gather
  /// light as no optic does.
  void require_near(const std::string& file, std::size_t triangle, const Vec3& normal) const {
    const double off_deg = std::acos(std::clamp(dot(normal, flat_[triangle]), -1.0, 1.0)) / kDegree;
    if (off_deg > kFarthestNormalDeg)
      throw InputError(file,
                       "a facet with corner " + shown_point(mesh_.corners[mesh_.triangles[triangle][0]]),
                       "an interpolated normal " + std::to_string(off_deg) + " degrees off",
                       "10 degrees at most: smaller facets, less crease_deg, or facet normals");
  }
  double area(std::size_t triangle) const {
    const auto& t = mesh_.triangles[triangle];
    const Vec3& a = mesh_.corners[t[0]];
    return 0.5 * length(cross(mesh_.corners[t[1]] - a, mesh_.corners[t[2]] - a));
  }
  /// By areas: so the normals' mean is that of the sheet as a whole, and teeth too fine to see send light
  /// where a flat sheet would.
  void smooth(double min_cosine) {
    std::vector<std::vector<std::pair<std::uint32_t, double>>> around(mesh_.corners.size());
    for (std::size_t k = 0; k < mesh_.triangles.size(); ++k) {
      for (const std::uint32_t corner : mesh_.triangles[k])
        around[corner].emplace_back(static_cast<std::uint32_t>(k), area(k));
    }
    smooth_.resize(mesh_.triangles.size());
    for (std::size_t k = 0; k < mesh_.triangles.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        Vec3 sum;
        for (const auto& [other, weight] : around[mesh_.triangles[k][i]]) {
          if (dot(flat_[k], flat_[other]) >= min_cosine) sum = sum + weight * flat_[other];
        }
        smooth_[k][i] = unit(sum);
      }
    }
  }

  Triangles mesh_;
  std::vector<Vec3> flat_;
  std::vector<std::array<Vec3, 3>> smooth_;
};

}  // namespace

std::unique_ptr<Surface> read_stl(const std::string& file, const Frame& place, double crease_deg) {
  return std::make_unique<StlSurface>(file, read_facets(file), place, crease_deg);
}

}  // namespace bench
