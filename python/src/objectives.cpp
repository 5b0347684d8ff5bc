// SPDX-License-Identifier: Apache-2.0
#include "call.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kCallDoc = R"(__call__(x)
--

Residuals and their exact Jacobian, new arrays that may be written.

Parameters
----------
x : array_like (n,)
    Parameters, mm.

Returns
-------
residuals : numpy.ndarray (m,)
    Dimensionless.
jacobian : numpy.ndarray (m, n)
    1/mm.)";

constexpr const char* kResidualsDoc = R"(residuals(x)
--

Residuals alone, in half the time; a new array that may be written.

Parameters
----------
x : array_like (n,)
    Parameters, mm.

Returns
-------
numpy.ndarray (m,)
    Dimensionless.)";

constexpr const char* kJacobianDoc = R"(jacobian(x)
--

The exact Jacobian of the residuals; a new array that may be written.

Parameters
----------
x : array_like (n,)
    Parameters, mm.

Returns
-------
numpy.ndarray (m, n)
    1/mm.)";

constexpr const char* kMetricsDoc = R"(metrics(x)
--

What the residuals come to.

Parameters
----------
x : array_like (n,)
    Parameters, mm.

Returns
-------
Record
    relative_rms (of the light, without limits), floor (what the noise of the rays makes of it), scale (what
    the light is multiplied by), efficiency (share of the sources' flux that leaves).)";

constexpr const char* kSceneDoc = R"(scene(x)
--

The scene with the mirror of given parameters.

Parameters
----------
x : array_like (n,)
    Parameters, mm.

Returns
-------
Scene)";

}  // namespace

namespace {

ObjectiveHandle make_objective(const SceneHandle& scene, double rays, Seed seed, std::optional<double> rim_mm,
                               const py::object& callback) {
  const ObjectiveOptions options{ray_count(rays), seed, rim_mm};
  return watched(callback, OnInterrupt::raise, [&](Watch& watch) {
    const SceneState& s = *scene.state;
    return ObjectiveHandle{std::make_shared<Objective>(s.project, s.path.string(), options, watch), scene,
                           options};
  });
}

std::vector<double> parameters_of(const py::object& x) { return input_row<double>(x, "x"); }

ObjectiveValue evaluate(const ObjectiveHandle& f, const py::object& x, bool jacobian) {
  const std::vector<double> parameters = parameters_of(x);
  return released([&] { return f.objective->at(parameters, jacobian); });
}

py::array_t<double> jacobian_of(const ObjectiveHandle& f, ObjectiveValue& value) {
  return fresh(std::move(value.jacobian),
               grid(f.objective->residual_count(), f.objective->parameter_count()));
}

py::object metrics(const ObjectiveHandle& f, const py::object& x) {
  const ObjectiveValue value = evaluate(f, x, false);
  py::dict out;
  out["relative_rms"] = value.relative_rms;
  out["floor"] = value.floor;
  out["scale"] = value.scale;
  out["efficiency"] = value.efficiency;
  return record(out);
}

SceneHandle scene_at(const ObjectiveHandle& f, const py::object& x) {
  const std::string text = f.objective->project_text(parameters_of(x));
  return read_scene(text, f.scene.state->path, f.scene.state->memory);
}

}  // namespace

void add_objective(py::module_& m) {
  auto c = py::class_<ObjectiveHandle>(m, "_Objective");
  c.def(py::init(&make_objective), "scene"_a, py::kw_only(), "rays"_a, "seed"_a, "rim_mm"_a, "callback"_a);
  c.def_property_readonly(
      "x0", [](const ObjectiveHandle& f) { return owned(f.objective->start()); },
      "Parameters of the mirror to begin with, mm: float64 (n,).");
  c.def_property_readonly(
      "shape",
      [](const ObjectiveHandle& f) {
        return py::make_tuple(f.objective->residual_count(), f.objective->parameter_count());
      },
      "Numbers of residuals and parameters: the shape of the Jacobian.");
  c.def(
      "__call__",
      [](const ObjectiveHandle& f, const py::object& x) {
        ObjectiveValue value = evaluate(f, x, true);
        return py::make_tuple(fresh(std::move(value.residuals)), jacobian_of(f, value));
      },
      "x"_a, kCallDoc);
  c.def(
      "residuals",
      [](const ObjectiveHandle& f, const py::object& x) {
        return fresh(std::move(evaluate(f, x, false).residuals));
      },
      "x"_a, kResidualsDoc);
  c.def(
      "jacobian",
      [](const ObjectiveHandle& f, const py::object& x) {
        ObjectiveValue value = evaluate(f, x, true);
        return jacobian_of(f, value);
      },
      "x"_a, kJacobianDoc);
  c.def("metrics", &metrics, "x"_a, kMetricsDoc);
  c.def("scene", &scene_at, "x"_a, kSceneDoc);
  c.def(py::pickle(
      [](const ObjectiveHandle& f) {
        return py::make_tuple(f.scene, f.options.rays, f.options.seed, f.options.rim_mm);
      },
      [](const py::tuple& s) {
        if (s.size() != 4) throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
        return make_objective(s[0].cast<SceneHandle>(), s[1].cast<double>(), Seed{s[2].cast<std::uint64_t>()},
                              s[3].cast<std::optional<double>>(), py::none());
      }));
}

}  // namespace lucerna::python
