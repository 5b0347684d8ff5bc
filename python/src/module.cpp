// SPDX-License-Identifier: Apache-2.0
// lucerna._core: the public library for Python. The package around it is python/lucerna.
#include "errors.h"
#include "lucerna/version.h"
#include "types.h"

PYBIND11_MODULE(_core, m) {
  namespace py = pybind11;
  using namespace lucerna::python;
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
}
