// SPDX-License-Identifier: Apache-2.0
// lucerna._core: the public library for Python. The package around it is python/lucerna.
#include "call.h"
#include "errors.h"
#include "lucerna/version.h"
#include "types.h"

namespace py = pybind11;

namespace {

/// What pybind11's own does, but a TypeError where it would end the process: for objects of its base class,
/// or of one that is derived from nothing else.
PyObject* new_instance(PyTypeObject* type, PyObject* /*arguments*/, PyObject* /*keys*/) {
  if (!py::detail::all_type_info(type).empty()) return py::detail::make_new_instance(type);
  PyErr_Format(PyExc_TypeError, "cannot create '%s' instances", type->tp_name);
  return nullptr;
}

/// From now on no attribute of the module's classes changes, and no object changes its class to or from one
/// of them: what an object holds is known by its class alone.
void seal(const py::module_& m) {
  for (const auto& [name, value] : m.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(value.ptr())) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(value.ptr());
    type->tp_flags |= Py_TPFLAGS_IMMUTABLETYPE;
    PyType_Modified(type);
  }
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  using namespace lucerna::python;
  reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base)->tp_new = &new_instance;
  // The documentation says what signatures are, in a form that `inspect` reads.
  py::options options;
  options.disable_function_signatures();
  m.doc() = "The public library of Lucerna; see lucerna.";
  m.attr("__version__") = std::string(lucerna::version());
  translate_errors();
  add_rays(m);
  add_models(m);
  add_intensity(m);
  add_planes(m);
  add_reflectors(m);
  add_scenes(m);
  add_traces(m);
  add_designs(m);
  add_objective(m);
  add_comparison(m);
  m.def("_seal", [m] { seal(m); });
  m.def("_is_forked", &is_forked);
  m.def("_check_call", [] { const Call call; });
  end_calls_at_exit();
}
