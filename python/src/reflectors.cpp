// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "call.h"
#include "lucerna/cad.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kHeightMmDoc = R"(height_mm(x_mm, y_mm)
--

Height over the xy plane of the mirror's own frame, mm.

Parameters
----------
x_mm, y_mm : array_like
    Places, mm; of one shape by numpy's rules.

Returns
-------
numpy.ndarray
    Not a number where there is no mirror.)";

constexpr const char* kSlopeDoc = R"(slope(x_mm, y_mm)
--

Exact gradient (dz/dx, dz/dy) of the surface.

Parameters
----------
x_mm, y_mm : array_like
    Places, mm; of one shape by numpy's rules.

Returns
-------
numpy.ndarray (..., 2)
    Not a number where there is no mirror.)";

constexpr const char* kMeshDoc = R"(mesh(*, chord_mm=0.01, slope_deg=2.0)
--

The mirror as triangles, counter-clockwise seen from the reflecting side.

Parameters
----------
chord_mm : float
    Largest distance of a triangle from the surface, mm.
slope_deg : float
    Largest angle between a triangle and the surface, degrees.

Returns
-------
vertices_mm : numpy.ndarray (n, 3)
    In the mirror's own frame, on the exact surface, mm.
triangles : numpy.ndarray (m, 3) of uint32
    Indices of corners.)";

constexpr const char* kProfileDoc = R"(profile(*, chord_mm=0.01, slope_deg=2.0)
--

The meridian at y = 0, x >= 0, from the hole to the rim.

Parameters
----------
chord_mm : float
    Largest distance of a chord from the curve, mm.
slope_deg : float
    Largest angle between a chord and the curve, degrees.

Returns
-------
numpy.ndarray (n, 2)
    r and z, mm.)";

constexpr const char* kSaveDoc = R"(save(path, *, chord_mm=0.01, slope_deg=2.0)
--

Writes the mirror for CAD, in its own frame, mm.

Parameters
----------
path : path_like
    .step and .stp hold the very surface, .stl and .obj triangles, .dxf and .csv the profile.
chord_mm : float
    Largest distance of a triangle or chord from the surface, mm.
slope_deg : float
    Largest angle of a triangle or chord to the surface, degrees.)";

constexpr const char* kReflectorClassDoc = R"(A mirror: its surface, outline, place and reflectance.

`Reflector(family, **keys)` takes the keys of a [[reflector]] table of a project file, with their names and
units: `Reflector('revolution', preset='parabola', focal_mm=15, diameter_mm=100, axis='-z')`. It never changes,
so threads may share it.)";

constexpr const char* kFromTomlDoc = R"(from_toml(text, folder='.')
--

The mirror of a text with one [[reflector]] table.

Parameters
----------
text : str
folder : path_like
    What file names in it are relative to.

Returns
-------
Reflector)";

}  // namespace

namespace {

namespace fs = std::filesystem;

Mirror mirror_of(const std::string& toml, const fs::path& folder) {
  return released([&] {
    std::vector<PlacedReflector> read = parse_reflectors(toml, folder / "reflector");
    if (read.size() != 1)
      throw InputError("found " + std::to_string(read.size()) + " reflectors, expected one");
    return Mirror{std::move(read.front()), toml};
  });
}

/// The same mirror, and the same text unless it names a file that is relative to `folder`.
Mirror mirror_from_text(const std::string& toml, const fs::path& folder) {
  Mirror read = mirror_of(toml, folder);
  read.toml = python_name("lucerna._toml", "absolute_reflector")(toml, folder).cast<std::string>();
  return read;
}

Mirror make_mirror(const std::string& family, const py::kwargs& keys) {
  const py::object text = python_name("lucerna._toml", "reflector_text")(family, **keys);
  return mirror_of(text.cast<std::string>(), fs::current_path());
}

/// `value(x, y, point)` at places of the mirror's xy plane; not a number where there is no mirror.
template <class Value>
py::array_t<double> over_places(const Mirror& mirror, const py::object& x_mm, const py::object& y_mm,
                                std::size_t width, const Value& value) {
  const Pair at = input_pair(x_mm, "x_mm", y_mm, "y_mm");
  const Reflector& r = mirror.placed.reflector;
  const auto n = static_cast<std::size_t>(at.first.size());
  std::vector<double> out(n * width, std::numeric_limits<double>::quiet_NaN());
  const double *x = at.first.data(), *y = at.second.data();
  released([&] {
    for (std::size_t i = 0; i < n; ++i) {
      if (r.aperture.contains(x[i], y[i])) value(r.surface->at(x[i], y[i]), out.data() + i * width);
    }
    return 0;
  });
  Shape shape = shape_of(at.first);
  if (width > 1) shape.push_back(static_cast<py::ssize_t>(width));
  return owned(std::move(out), shape);
}

py::array_t<double> height(const Mirror& mirror, const py::object& x_mm, const py::object& y_mm) {
  return over_places(mirror, x_mm, y_mm, 1, [](const SurfacePoint& p, double* out) { *out = p.z_mm; });
}

py::array_t<double> slope(const Mirror& mirror, const py::object& x_mm, const py::object& y_mm) {
  return over_places(mirror, x_mm, y_mm, 2, [](const SurfacePoint& p, double* out) {
    out[0] = p.dzdx;
    out[1] = p.dzdy;
  });
}

py::tuple mesh(const Mirror& mirror, double chord_mm, double slope_deg) {
  Mesh made = released([&] { return cad_mesh(mirror.placed.reflector, {chord_mm, slope_deg}); });
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * made.triangles.size());
  for (const auto& t : made.triangles) corners.insert(corners.end(), t.begin(), t.end());
  const Shape shape = grid(made.triangles.size(), 3);
  return py::make_tuple(owned(made.vertices_mm), owned(std::move(corners), shape));
}

py::array_t<double> profile(const Mirror& mirror, double chord_mm, double slope_deg) {
  const auto points = released([&] { return cad_profile(mirror.placed.reflector, {chord_mm, slope_deg}); });
  std::vector<double> flat;
  for (const auto& p : points) flat.insert(flat.end(), p.begin(), p.end());
  return owned(std::move(flat), grid(points.size(), 2));
}

std::string file_bytes(const Reflector& reflector, const std::string& ending, const CadTolerance& tolerance) {
  if (ending == ".step" || ending == ".stp") return step_text(reflector);
  if (ending == ".stl") return stl_bytes(cad_mesh(reflector, tolerance));
  if (ending == ".obj") return obj_text(cad_mesh(reflector, tolerance));
  if (ending == ".dxf") return dxf_profile(cad_profile(reflector, tolerance));
  if (ending == ".csv") return csv_profile(cad_profile(reflector, tolerance));
  throw UsageError("ending: found '" + ending + "', expected .step, .stp, .stl, .obj, .dxf or .csv",
                   "format");
}

void save(const Mirror& mirror, const fs::path& path, double chord_mm, double slope_deg) {
  const std::string bytes = released([&] {
    return file_bytes(mirror.placed.reflector, path.extension().string(), {chord_mm, slope_deg});
  });
  python_name("lucerna._types", "write_whole")(path, py::bytes(bytes));
}

py::object aperture(const Mirror& mirror) {
  const Aperture& a = mirror.placed.reflector.aperture;
  py::dict out;
  out["shape"] = a.shape() == ApertureShape::circle ? "circle" : "rectangle";
  out["size_mm"] = py::make_tuple(2.0 * a.half_x_mm(), 2.0 * a.half_y_mm());
  out["hole_diameter_mm"] = 2.0 * a.hole_radius_mm();
  return record(out);
}

void add_geometry(py::class_<Mirror>& c) {
  c.def("height_mm", &height, "x_mm"_a, "y_mm"_a, kHeightMmDoc);
  c.def("slope", &slope, "x_mm"_a, "y_mm"_a, kSlopeDoc);
  c.def("mesh", &mesh, py::kw_only(), "chord_mm"_a = 0.01, "slope_deg"_a = 2.0, kMeshDoc);
  c.def("profile", &profile, py::kw_only(), "chord_mm"_a = 0.01, "slope_deg"_a = 2.0, kProfileDoc);
  c.def("save", &save, "path"_a, py::kw_only(), "chord_mm"_a = 0.01, "slope_deg"_a = 2.0, kSaveDoc);
}

}  // namespace

void add_reflectors(py::module_& m) {
  auto c = py::class_<Mirror>(m, "Reflector", kReflectorClassDoc);
  c.def(py::init(&make_mirror), "family"_a, "__init__(self, family, **keys)\n--\n\n");
  c.def_static("from_toml", &mirror_from_text, "text"_a, "folder"_a = fs::path("."), kFromTomlDoc);
  c.def_property_readonly(
      "toml", [](const Mirror& r) { return r.toml; }, "The [[reflector]] table that describes it.");
  c.def_property_readonly("aperture", &aperture,
                          "Outline, as a Record: shape, size_mm (x, y) and hole_diameter_mm.");
  c.def_property_readonly(
      "position_mm", [](const Mirror& r) { return vector(r.placed.world_from_reflector.origin_mm()); },
      "Where the vertex is in the luminaire frame, mm.");
  c.def_property_readonly(
      "axis", [](const Mirror& r) { return vector(r.placed.world_from_reflector.ez()); },
      "Where the mirror opens to in the luminaire frame, as a unit vector.");
  add_geometry(c);
  c.def(py::pickle([](const Mirror& r) { return py::make_tuple(r.toml); },
                   [](const py::tuple& s) {
                     if (s.size() != 1)
                       throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
                     return mirror_of(s[0].cast<std::string>(),
                                      fs::path("/"));  // its file's name is absolute
                   }));
  c.def(
      "__eq__", [](const Mirror& a, const Mirror& b) { return a.toml == b.toml; }, py::is_operator());
  c.attr("__hash__") = py::none();
}

}  // namespace lucerna::python
