// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/geometry.h"

namespace lucerna {

/// A cubic B-spline curve: poles, knots and how often each counts.
struct StepCurve {
  std::vector<Vec3> poles;
  std::vector<double> knots;
  std::vector<int> multiplicity;
};

/// A bicubic B-spline surface; pole (u, v) is poles[v * count_u + u].
struct StepSurface {
  std::size_t count_u = 0;
  std::vector<Vec3> poles;
  std::vector<double> knots_u, knots_v;
  std::vector<int> multiplicity_u, multiplicity_v;
};

/// An edge and whether a loop runs along it.
using StepEdge = std::pair<int, bool>;

/// Collects entities of one shell and writes them as a STEP file: the clear text encoding of ISO
/// 10303-21 with the schema AUTOMOTIVE_DESIGN (ISO 10303-214) and the geometry and topology of ISO 10303-42.
/// Every call returns the entity's number. Loops run counter-clockwise seen from where their face looks to;
/// holes too (they are written the other way).
class StepWriter {
 public:
  int curve(const StepCurve& c);
  /// About the z axis at a height, from +x towards +y.
  int circle(double z_mm, double radius_mm);
  int surface(const StepSurface& s);
  /// A curve turned about the z axis.
  int revolution(int curve);
  int vertex(const Vec3& p);
  int edge(int from, int to, int curve);
  int loop(const std::vector<StepEdge>& edges);
  /// `same_sense`: the face looks to where the surface's normal does.
  int face(int surface, bool same_sense, int outer, const std::vector<int>& holes);

  /// The whole file; to be called once, last. `closed`: the faces bound a solid, all looking out of it.
  std::string text(const std::string& name, bool closed = false);

 private:
  int add(const std::string& entity);
  int point(const Vec3& p);
  int direction(const Vec3& d);
  int placement(const Vec3& origin);

  std::string data_;
  int last_ = 0;
  std::vector<int> faces_;
};

}  // namespace lucerna
