// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/cad/step_writer.h"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna {

namespace {

/// A real of the clear text encoding always has a decimal point.
std::string real(double x) {
  std::string text = fmt::format("{:.15G}", x + 0.0);
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('E'), text.size()), 1, '.');
  return text;
}

std::string reference(int i) { return fmt::format("#{}", i); }
std::string logical(bool x) { return x ? ".T." : ".F."; }

template <class List, class Text>
std::string list(const List& items, const Text& text) {
  std::string out = "(";
  for (const auto& item : items) {
    if (out.size() > 1) out += ',';
    out += text(item);
  }
  out += ')';
  return out;
}

std::string numbers(const std::vector<double>& x) { return list(x, real); }
std::string counts(const std::vector<int>& x) {
  return list(x, [](int i) { return std::to_string(i); });
}

/// Strings are quoted, their quotes doubled, other characters than printable ASCII left out.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c < ' ' || c > '~') continue;
    out += c;
    if (c == '\'' || c == '\\') out += c;
  }
  out += '\'';
  return out;
}

}  // namespace

int StepWriter::add(const std::string& entity) {
  data_ += fmt::format("#{}={};\n", ++last_, entity);
  return last_;
}

int StepWriter::point(const Vec3& p) { return add("CARTESIAN_POINT(''," + numbers({p.x, p.y, p.z}) + ")"); }

int StepWriter::direction(const Vec3& d) { return add("DIRECTION(''," + numbers({d.x, d.y, d.z}) + ")"); }

int StepWriter::placement(const Vec3& origin) {
  const int o = point(origin), z = direction({0, 0, 1}), x = direction({1, 0, 0});
  return add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", o, z, x));
}

int StepWriter::curve(const StepCurve& c) {
  std::vector<int> poles;
  for (const Vec3& p : c.poles) poles.push_back(point(p));
  return add(fmt::format("B_SPLINE_CURVE_WITH_KNOTS('',3,{},.UNSPECIFIED.,.F.,.F.,{},{},.UNSPECIFIED.)",
                         list(poles, reference), counts(c.multiplicity), numbers(c.knots)));
}

int StepWriter::circle(double z_mm, double radius_mm) {
  const int axis = placement({0, 0, z_mm});
  return add(fmt::format("CIRCLE('',#{},{})", axis, real(radius_mm)));
}

int StepWriter::surface(const StepSurface& s) {
  std::vector<std::vector<int>> poles(s.count_u);  // STEP lists poles by u first
  for (std::size_t i = 0; i < s.poles.size(); ++i) poles[i % s.count_u].push_back(point(s.poles[i]));
  const auto row = [](const std::vector<int>& r) { return list(r, reference); };
  return add(fmt::format(
      "B_SPLINE_SURFACE_WITH_KNOTS('',3,3,{},.UNSPECIFIED.,.F.,.F.,.F.,{},{},{},{},.UNSPECIFIED.)",
      list(poles, row), counts(s.multiplicity_u), counts(s.multiplicity_v), numbers(s.knots_u),
      numbers(s.knots_v)));
}

int StepWriter::revolution(int curve) {
  const int o = point({0, 0, 0}), z = direction({0, 0, 1});
  const int axis = add(fmt::format("AXIS1_PLACEMENT('',#{},#{})", o, z));
  return add(fmt::format("SURFACE_OF_REVOLUTION('',#{},#{})", curve, axis));
}

int StepWriter::vertex(const Vec3& p) {
  const int at = point(p);
  return add(fmt::format("VERTEX_POINT('',#{})", at));
}

int StepWriter::edge(int from, int to, int curve) {
  return add(fmt::format("EDGE_CURVE('',#{},#{},#{},.T.)", from, to, curve));
}

int StepWriter::loop(const std::vector<StepEdge>& edges) {
  std::vector<int> oriented;
  for (const auto& [edge, along] : edges) {
    oriented.push_back(add(fmt::format("ORIENTED_EDGE('',*,*,#{},{})", edge, logical(along))));
  }
  return add("EDGE_LOOP(''," + list(oriented, reference) + ")");
}

int StepWriter::face(int surface, bool same_sense, int outer, const std::vector<int>& holes) {
  std::vector<int> bounds{add(fmt::format("FACE_OUTER_BOUND('',#{},.T.)", outer))};
  for (const int hole : holes) bounds.push_back(add(fmt::format("FACE_BOUND('',#{},.F.)", hole)));
  faces_.push_back(
      add(fmt::format("ADVANCED_FACE('',{},#{},{})", list(bounds, reference), surface, logical(same_sense))));
  return faces_.back();
}

std::string StepWriter::text(const std::string& name, bool closed) {
  const std::string title = quoted(name);
  const int shell = add((closed ? "CLOSED_SHELL(''," : "OPEN_SHELL('',") + list(faces_, reference) + ")");
  const int model = add(closed ? fmt::format("MANIFOLD_SOLID_BREP('',#{})", shell)
                               : fmt::format("SHELL_BASED_SURFACE_MODEL('',(#{}))", shell));
  const int origin = placement({0, 0, 0});
  const int millimetre = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
  const int radian = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int steradian = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int accuracy = add(fmt::format(
      "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#{},'distance_accuracy_value','')", millimetre));
  const int context =
      add(fmt::format("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{}))"
                      "GLOBAL_UNIT_ASSIGNED_CONTEXT((#{},#{},#{}))REPRESENTATION_CONTEXT('',''))",
                      accuracy, millimetre, radian, steradian));
  const int shape =
      add(fmt::format("{}({},(#{},#{}),#{})",
                      closed ? "ADVANCED_BREP_SHAPE_REPRESENTATION" : "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
                      title, origin, model, context));
  const int application = add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
  add(fmt::format("APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{})",
                  application));
  const int mechanical = add(fmt::format("PRODUCT_CONTEXT('',#{},'mechanical')", application));
  const int product = add(fmt::format("PRODUCT({},{},'',(#{}))", title, title, mechanical));
  add(fmt::format("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{}))", product));
  const int formation = add(fmt::format("PRODUCT_DEFINITION_FORMATION('','',#{})", product));
  const int part =
      add(fmt::format("PRODUCT_DEFINITION_CONTEXT('part definition',#{},'design')", application));
  const int definition = add(fmt::format("PRODUCT_DEFINITION('design','',#{},#{})", formation, part));
  const int defined = add(fmt::format("PRODUCT_DEFINITION_SHAPE('','',#{})", definition));
  add(fmt::format("SHAPE_DEFINITION_REPRESENTATION(#{},#{})", defined, shape));
  return std::string("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('") + (closed ? "solid" : "mirror surface") +
         ", mm'),'2;1');\nFILE_NAME(" + title +
         ",'1970-01-01T00:00:00',(''),(''),'Lucerna','Lucerna','');\n"
         "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n" +
         data_ + "ENDSEC;\nEND-ISO-10303-21;\n";
}

}  // namespace lucerna
