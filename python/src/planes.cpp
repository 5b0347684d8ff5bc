// SPDX-License-Identifier: Apache-2.0
#include "call.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kPlaneImageClassDoc = R"(Illuminance on a plane, or a luminance image, by cell.

Its values are worked out when they are first asked for. It never changes, so threads may share it, and it
pickles without loss.)";

}  // namespace

namespace {

std::shared_ptr<const PlaneMetrics> figures_of(const Plane& p) {
  return released([&] { return p.figures(); });
}

py::object cells(const py::object& self, std::vector<double> PlaneImage::*member) {
  const auto& p = self.cast<const Plane&>();
  const std::shared_ptr<const PlaneMetrics> figures = figures_of(p);
  // The trace that `self` has, or `self`, keeps them as long as the view keeps `self`.
  return view(figures->image.*member, grid(figures->image.grid.ny, figures->image.grid.nx), self);
}

py::array_t<double> centres(const PlaneGrid& g, bool along_x) {
  std::vector<double> out(along_x ? g.nx : g.ny);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = along_x ? g.cell_x_mm(i) : g.cell_y_mm(i * g.nx);
  return owned(std::move(out));
}

void add_figures(py::class_<Plane>& c) {
  const auto figure = [&](const char* name, auto get, const char* doc) {
    c.def_property_readonly(
        name, [get](const Plane& p) { return get(*figures_of(p)); }, doc);
  };
  figure(
      "flux", [](const PlaneMetrics& m) { return estimate(m.image.flux); }, "Flux of all cells, lm (or W).");
  figure(
      "mean", [](const PlaneMetrics& m) { return estimate(m.extremes.mean); }, "Mean, in `unit`.");
  figure(
      "min", [](const PlaneMetrics& m) { return estimate(m.extremes.min); },
      "Minimum, corrected for the noise of the cells, in `unit`.");
  figure(
      "max", [](const PlaneMetrics& m) { return estimate(m.extremes.max); },
      "Maximum, corrected for the noise of the cells, in `unit`.");
  figure(
      "uniformity", [](const PlaneMetrics& m) { return estimate(m.extremes.uniformity); },
      "Minimum over mean; None for a dark plane.");
  figure(
      "peak_mm", [](const PlaneMetrics& m) { return py::make_tuple(m.peak_x_mm, m.peak_y_mm); },
      "Centre of the brightest cell in the frame of the grid, mm.");
  figure(
      "noise", [](const PlaneMetrics& m) { return m.noise; }, "Relative noise of the whole image.");
}

bool equal(const PlaneMetrics& a, const PlaneMetrics& b) {
  return a.image.name == b.image.name && a.image.grid == b.image.grid && a.image.unit == b.image.unit &&
         a.view == b.view && a.image.value == b.image.value;
}

py::tuple state_of(const Frame& f) {
  return py::make_tuple(vector(f.ex()), vector(f.ey()), vector(f.ez()), vector(f.origin_mm()));
}

Vec3 vector_of(const py::handle& given) {
  const auto v = given.cast<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

py::tuple state_of(const PlaneGrid& g) {
  return py::make_tuple(state_of(g.world_from_plane), g.size_x_mm, g.size_y_mm, g.nx, g.ny);
}

PlaneGrid grid_of(const py::tuple& s) {
  const auto frame = s[0].cast<py::tuple>();
  constexpr std::size_t kMaxCells = std::size_t{1} << 24;  // as in a project file
  const auto nx = s[3].cast<std::size_t>(), ny = s[4].cast<std::size_t>();
  if (nx == 0 || ny == 0 || nx > kMaxCells / ny)
    throw InputError("a damaged pickle of an image", ErrorCause::damaged);
  return {{vector_of(frame[0]), vector_of(frame[1]), vector_of(frame[2]), vector_of(frame[3])},
          s[1].cast<double>(),
          s[2].cast<double>(),
          nx,
          ny};
}

py::tuple state_of(const Estimate& e) { return py::make_tuple(e.mean, e.standard_error); }

Estimate estimate_of(const py::handle& given) {
  const auto pair = given.cast<std::array<double, 2>>();
  return {pair[0], pair[1]};
}

/// All of a PlaneMetrics, as plain Python objects and arrays.
py::tuple state(const py::object& self) {
  const std::shared_ptr<const PlaneMetrics> m = figures_of(self.cast<const Plane&>());
  const PlaneExtremes& e = m->extremes;
  py::object observer = py::none(), uniformity = py::none();
  if (m->view)
    observer = py::make_tuple(m->view->name, state_of(m->view->grid), m->view->half_angle_deg,
                              m->view->distance_mm, m->view->pupil_radius_mm);
  if (e.uniformity) uniformity = state_of(*e.uniformity);
  return py::make_tuple(m->image.name, state_of(m->image.grid), std::string(symbol(m->image.unit)),
                        self.attr("value"), self.attr("standard_error"), state_of(m->image.flux), observer,
                        state_of(e.mean), state_of(e.min), state_of(e.max), uniformity, e.max_cell,
                        m->peak_x_mm, m->peak_y_mm, m->noise);
}

std::vector<double> cells_of(const py::handle& given, const PlaneGrid& grid) {
  // Errors that are not known are not a number.
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array || static_cast<std::size_t>(array.size()) != grid.size())
    throw InputError("a damaged pickle of an image", ErrorCause::damaged);
  return {array.data(), array.data() + array.size()};
}

Plane from_state(const py::tuple& s) {
  if (s.size() != 15) throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
  auto m = std::make_shared<PlaneMetrics>();
  m->image.name = s[0].cast<std::string>();
  m->image.grid = grid_of(s[1].cast<py::tuple>());
  m->image.unit = flux_unit(s[2].cast<std::string>());
  m->image.value = cells_of(s[3], m->image.grid);
  m->image.standard_error = cells_of(s[4], m->image.grid);
  m->image.flux = estimate_of(s[5]);
  if (!s[6].is_none()) {
    const auto v = s[6].cast<py::tuple>();
    m->view = LuminanceDetector{v[0].cast<std::string>(), grid_of(v[1].cast<py::tuple>()),
                                v[2].cast<double>(), v[3].cast<double>(), v[4].cast<double>()};
  }
  m->extremes.mean = estimate_of(s[7]);
  m->extremes.min = estimate_of(s[8]);
  m->extremes.max = estimate_of(s[9]);
  if (!s[10].is_none()) m->extremes.uniformity = estimate_of(s[10]);
  m->extremes.max_cell = s[11].cast<std::size_t>();
  m->peak_x_mm = s[12].cast<double>();
  m->peak_y_mm = s[13].cast<double>();
  m->noise = s[14].cast<double>();
  return {m};
}

}  // namespace

std::shared_ptr<const PlaneMetrics> Plane::figures() const {
  if (!trace) return counted;
  const Traced::Figures exact = trace->images();
  return {exact, &(is_luminance ? exact->luminances : exact->planes)[index]};
}

void add_planes(py::module_& m) {
  auto c = py::class_<Plane>(m, "PlaneImage", kPlaneImageClassDoc);
  c.def_property_readonly(
      "name", [](const Plane& p) { return p.counted->image.name; }, "Of the detector.");
  c.def_property_readonly(
      "unit", [](const Plane& p) { return plane_unit(*p.counted); }, "'lx', 'cd/m2', 'W/m2' or 'W/(m2 sr)'.");
  c.def_property_readonly(
      "value", [](const py::object& self) { return cells(self, &PlaneImage::value); },
      "The figure of each cell, in `unit`: float64 (ny, nx), a read-only view.");
  c.def_property_readonly(
      "standard_error", [](const py::object& self) { return cells(self, &PlaneImage::standard_error); },
      "Standard error of each value, in `unit`: float64 (ny, nx), a read-only view.");
  c.def_property_readonly(
      "x_mm", [](const Plane& p) { return centres(p.counted->image.grid, true); },
      "Centres of the cells along x, in the frame of the grid, mm.");
  c.def_property_readonly(
      "y_mm", [](const Plane& p) { return centres(p.counted->image.grid, false); },
      "Centres of the cells along y, in the frame of the grid, mm.");
  c.def_property_readonly(
      "is_luminance", [](const Plane& p) { return p.counted->view.has_value(); },
      "True for a luminance image, False for illuminance on a plane.");
  add_figures(c);
  c.def(
      "__eq__", [](const Plane& a, const Plane& b) { return equal(*figures_of(a), *figures_of(b)); },
      py::is_operator());
  c.attr("__hash__") = py::none();
  c.def(py::pickle(&state, &from_state));
}

}  // namespace lucerna::python
