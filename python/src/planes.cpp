// SPDX-License-Identifier: Apache-2.0
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kPlaneImageClassDoc = R"(Illuminance on a plane, or a luminance image, by cell.

It never changes, so threads may share it.)";

}  // namespace

namespace {

Shape shape_of(const Plane& p) { return grid(p.metrics->image.grid.ny, p.metrics->image.grid.nx); }

py::array_t<double> centres(const PlaneGrid& g, bool along_x) {
  std::vector<double> out(along_x ? g.nx : g.ny);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = along_x ? g.cell_x_mm(i) : g.cell_y_mm(i * g.nx);
  return owned(std::move(out));
}

void add_figures(py::class_<Plane>& c) {
  const auto figure = [&](const char* name, auto get, const char* doc) {
    c.def_property_readonly(
        name, [get](const Plane& p) { return get(*p.metrics); }, doc);
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

}  // namespace

void add_planes(py::module_& m) {
  auto c = py::class_<Plane>(m, "PlaneImage", kPlaneImageClassDoc);
  c.def_property_readonly(
      "name", [](const Plane& p) { return p.metrics->image.name; }, "Of the detector.");
  c.def_property_readonly(
      "unit", [](const Plane& p) { return plane_unit(*p.metrics); }, "'lx', 'cd/m2', 'W/m2' or 'W/(m2 sr)'.");
  c.def_property_readonly(
      "value",
      [](const py::object& self) {
        const auto& p = self.cast<const Plane&>();
        return view(p.metrics->image.value, shape_of(p), self);
      },
      "The figure of each cell, in `unit`: float64 (ny, nx), a read-only view.");
  c.def_property_readonly(
      "standard_error",
      [](const py::object& self) {
        const auto& p = self.cast<const Plane&>();
        return view(p.metrics->image.standard_error, shape_of(p), self);
      },
      "Standard error of each value, in `unit`: float64 (ny, nx), a read-only view.");
  c.def_property_readonly(
      "x_mm", [](const Plane& p) { return centres(p.metrics->image.grid, true); },
      "Centres of the cells along x, in the frame of the grid, mm.");
  c.def_property_readonly(
      "y_mm", [](const Plane& p) { return centres(p.metrics->image.grid, false); },
      "Centres of the cells along y, in the frame of the grid, mm.");
  c.def_property_readonly(
      "is_luminance", [](const Plane& p) { return p.metrics->view.has_value(); },
      "True for a luminance image, False for illuminance on a plane.");
  add_figures(c);
}

}  // namespace lucerna::python
