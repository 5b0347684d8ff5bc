// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/optics/shapes/trough_surface.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

/// A STEP file read back: entities by number, as text.
class StepFile {
 public:
  explicit StepFile(const std::string& text) {
    for (const std::string& entity : test::between(text, "\n#", ";")) {
      const std::size_t equal = entity.find('=');
      if (equal != std::string::npos) entities_[std::stoi(entity)] = entity.substr(equal + 1);
    }
    EXPECT_EQ(text.substr(0, 14), "ISO-10303-21;\n");
    EXPECT_NE(text.find("END-ISO-10303-21;"), std::string::npos);
  }

  const std::map<int, std::string>& entities() const { return entities_; }
  const std::string& at(int i) const { return entities_.at(i); }
  std::vector<int> of(const std::string& type) const {
    std::vector<int> out;
    for (const auto& [number, text] : entities_) {
      if (text.rfind(type + "(", 0) == 0) out.push_back(number);
    }
    return out;
  }
  /// Numbers of the entities that one refers to, in order.
  std::vector<int> references(int i) const {
    std::vector<int> out;
    const std::string& text = at(i);
    for (std::size_t k = text.find('#'); k != std::string::npos; k = text.find('#', k + 1)) {
      out.push_back(std::stoi(text.substr(k + 1, 12)));
    }
    return out;
  }
  Vec3 point(int i) const {
    const std::vector<double> x = test::numbers_in(at(i).substr(at(i).find("(''") + 3));
    return {x.at(0), x.at(1), x.at(2)};
  }
  /// The lists of plain numbers in an entity: multiplicities and knots.
  std::vector<std::vector<double>> lists(int i) const {
    std::vector<std::vector<double>> out;
    const std::string& text = at(i);
    for (std::size_t k = text.find('('); k != std::string::npos; k = text.find('(', k + 1)) {
      const std::size_t end = text.find_first_not_of("-0123456789.E+,", k + 1);
      if (end != std::string::npos && end > k + 1 && text[end] == ')')
        out.push_back(test::numbers_in(text.substr(k + 1, end - k - 1)));
    }
    return out;
  }

 private:
  std::map<int, std::string> entities_;
};

std::vector<double> full_knots(const std::vector<double>& multiplicity, const std::vector<double>& knots) {
  std::vector<double> out;
  for (std::size_t i = 0; i < knots.size(); ++i)
    out.insert(out.end(), static_cast<std::size_t>(multiplicity[i]), knots[i]);
  return out;
}

/// de Boor's algorithm, degree 3.
Vec3 de_boor(const std::vector<double>& knots, std::vector<Vec3> poles, double t) {
  std::size_t k = 3;
  while (k + 1 < poles.size() && knots[k + 1] <= t) ++k;
  std::vector<Vec3> d(poles.begin() + static_cast<std::ptrdiff_t>(k) - 3,
                      poles.begin() + static_cast<std::ptrdiff_t>(k) + 1);
  for (std::size_t r = 1; r <= 3; ++r) {
    for (std::size_t j = 3; j >= r; --j) {
      const double low = knots[j + k - 3], high = knots[j + 1 + k - r], a = (t - low) / (high - low);
      d[j] = (1.0 - a) * d[j - 1] + a * d[j];
    }
  }
  return d[3];
}

struct Curve {
  std::vector<double> knots;
  std::vector<Vec3> poles;
  Vec3 at(double t) const { return de_boor(knots, poles, t); }
};

Curve curve_of(const StepFile& file, int i) {
  Curve c;
  const auto lists = file.lists(i);
  c.knots = full_knots(lists.at(0), lists.at(1));
  for (const int p : file.references(i)) c.poles.push_back(file.point(p));
  EXPECT_EQ(c.knots.size(), c.poles.size() + 4);
  return c;
}

Reflector free_form(const Aperture& aperture, int nx = 5, int ny = 3) {
  const double a = aperture.half_x_mm(), b = aperture.half_y_mm();
  const KnotRow x{-a, 2.0 * a / nx, nx}, y{-b, 2.0 * b / ny, ny};
  std::vector<double> c(static_cast<std::size_t>((nx + 3) * (ny + 3)));
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = 0.7 * std::sin(2.0 * static_cast<double>(i));
  return {std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(15.0, x, y, c)), aperture};
}

Reflector turned(const Aperture& aperture, int n = 6) {
  const KnotRow row{0.0, aperture.half_x_mm() / n, n};
  std::vector<double> c(static_cast<std::size_t>(n + 3));
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = 0.5 * std::sin(3.0 * static_cast<double>(i));
  c[0] = c[2];
  return {std::make_shared<SmoothSurface<RevolutionShape>>(RevolutionShape(12.0, row, c)), aperture};
}

/// Everything that is referred to is there, and every loop's edges meet end to end.
void expect_whole(const StepFile& file) {
  for (const auto& [number, text] : file.entities()) {
    for (const int r : file.references(number))
      EXPECT_TRUE(file.entities().count(r)) << number << " -> " << r;
  }
  for (const int loop : file.of("EDGE_LOOP")) {
    std::vector<std::pair<int, int>> ends;
    for (const int oriented : file.references(loop)) {
      const int edge = file.references(oriented).at(0);
      const auto r = file.references(edge);
      const bool along = file.at(oriented).find(".T.") != std::string::npos;
      ends.emplace_back(along ? r.at(0) : r.at(1), along ? r.at(1) : r.at(0));
    }
    for (std::size_t i = 0; i < ends.size(); ++i) {
      EXPECT_EQ(ends[i].second, ends[(i + 1) % ends.size()].first) << "loop #" << loop;
    }
  }
}

TEST(StepExport, TheFreeFormSurfaceIsTheOneThatIsTraced) {
  for (const auto& [nx, ny] : {std::pair{5, 3}, std::pair{1, 1}, std::pair{2, 8}}) {
    const Reflector reflector = free_form(Aperture::rectangle(60, 40), nx, ny);
    const StepFile file(step_text(reflector));
    expect_whole(file);
    const auto surfaces = file.of("B_SPLINE_SURFACE_WITH_KNOTS");
    ASSERT_EQ(surfaces.size(), 1u);
    const auto lists = file.lists(surfaces[0]);
    // The last four lists are multiplicities and knots; those before hold references only.
    ASSERT_EQ(lists.size(), 4u);
    const auto u = full_knots(lists[0], lists[2]), v = full_knots(lists[1], lists[3]);
    const auto poles = file.references(surfaces[0]);
    const std::size_t nu = u.size() - 4, nv = v.size() - 4;
    ASSERT_EQ(poles.size(), nu * nv);
    for (double x = -30; x <= 30; x += 12.5) {
      for (double y = -20; y <= 20; y += 6.25) {
        std::vector<Vec3> along_u;
        for (std::size_t i = 0; i < nu; ++i) {
          std::vector<Vec3> column;
          for (std::size_t j = 0; j < nv; ++j) column.push_back(file.point(poles[i * nv + j]));
          along_u.push_back(de_boor(v, column, y));
        }
        const Vec3 p = de_boor(u, along_u, x);
        EXPECT_NEAR(p.x, x, 1e-11);
        EXPECT_NEAR(p.y, y, 1e-11);
        EXPECT_NEAR(p.z, reflector.surface->at(x, y).z_mm, 1e-10) << nx << " " << x << " " << y;
      }
    }
  }
}

TEST(StepExport, RimsLieOnTheSurface) {
  for (const Reflector& reflector :
       {free_form(Aperture::circle(50, 8)), free_form(Aperture::rectangle(60, 40, 8))}) {
    const StepFile file(step_text(reflector));
    expect_whole(file);
    EXPECT_EQ(file.of("FACE_BOUND").size(), 1u);
    double widest = 0.0, min = 1e9, area = 0.0;
    for (const int edge : file.of("EDGE_CURVE")) {
      const Curve c = curve_of(file, file.references(edge).at(2));
      Vec3 before = c.at(c.knots.front());
      for (int i = 0; i <= 200; ++i) {
        const double t = c.knots.front() + (c.knots.back() - c.knots.front()) * i / 200.0;
        const Vec3 p = c.at(t);
        EXPECT_NEAR(p.z, reflector.surface->at(p.x, p.y).z_mm, 2e-6);
        widest = std::max(widest, std::hypot(p.x, p.y));
        min = std::min(min, std::hypot(p.x, p.y));
        area += 0.5 * std::abs(before.x * p.y - before.y * p.x);
        before = p;
      }
    }
    EXPECT_NEAR(min, 4.0, 2e-6);
    EXPECT_NEAR(widest, reflector.aperture.outer_radius_mm(), 2e-6);
    const double outline =
        reflector.aperture.shape() == ApertureShape::circle ? std::numbers::pi * 625.0 : 2400.0;
    EXPECT_NEAR(area, outline + std::numbers::pi * 16.0, 0.05);
  }
}

TEST(StepExport, TheSweptProfileIsTheOneThatIsTraced) {
  std::vector<Reflector> cases{turned(Aperture::circle(50)), turned(Aperture::circle(50, 8)),
                               turned(Aperture::circle(50, 8), 1)};
  cases.push_back(profile_reflector({{0, 0}, {10, 1.8}, {18, 5.2}, {25, 11}}, Aperture::circle(50, 8)));
  for (const Reflector& reflector : cases) {
    const StepFile file(step_text(reflector));
    expect_whole(file);
    const auto swept = file.of("SURFACE_OF_REVOLUTION");
    ASSERT_EQ(swept.size(), 1u);
    const Curve c = curve_of(file, file.references(swept[0]).at(0));
    for (double t = c.knots.front(); t < c.knots.back(); t += 0.37) {
      const Vec3 p = c.at(t);
      EXPECT_NEAR(p.x, t, 1e-9);
      EXPECT_EQ(p.y, 0.0);
      EXPECT_NEAR(p.z, reflector.surface->at(p.x, 0.0).z_mm, 2e-6);
    }
    const double hole = reflector.aperture.hole_radius_mm();
    EXPECT_EQ(file.of("CIRCLE").size(), hole > 0.0 ? 2u : 1u);
    EXPECT_EQ(file.of("ADVANCED_FACE").size(), 2u);
    for (const int v : file.of("VERTEX_POINT")) {
      const Vec3 p = file.point(file.references(v).at(0));
      const double r = std::abs(p.x);
      EXPECT_TRUE(r == hole || r == 25.0) << r;
      EXPECT_NEAR(p.z, reflector.surface->at(r, 0.0).z_mm, 1e-9);
    }
  }
}

TEST(StepExport, SaysWhatItHasNoSurfaceFor) {
  const Reflector trough = conic_trough(ConicPreset::parabola, 10.0, 0.0, Aperture::rectangle(40, 40));
  EXPECT_THROW(step_text(trough), InputError);
}

TEST(StepExport, NamesAreQuotedAndTextIsReproducible) {
  const Reflector r = turned(Aperture::circle(50));
  EXPECT_NE(step_text(r, "it's\n").find("'it''s'"), std::string::npos);
  EXPECT_EQ(step_text(r), step_text(r));
}

}  // namespace
}  // namespace lucerna
