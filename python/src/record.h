// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <span>
#include <string>

#include "arrays.h"
#include "lucerna/estimate.h"

namespace lucerna::python {

/// A class or function of the package's own Python files.
inline py::object python_name(const char* module, const char* name) {
  return py::module_::import(module).attr(name);
}

/// lucerna.Record: named figures.
inline py::object record(const py::dict& fields) { return python_name("lucerna._types", "Record")(fields); }

/// The items of any mapping; TypeError for other things.
inline py::dict mapping(const py::object& given, const std::string& name) {
  if (py::isinstance<py::dict>(given)) return py::reinterpret_borrow<py::dict>(given);
  if (!py::isinstance(given, python_name("collections.abc", "Mapping")))
    throw py::type_error(name + ": expected a mapping, found " +
                         std::string(py::str(py::type::of(given).attr("__name__"))));
  return py::dict(given);
}

/// A Python object kept as the bytes of its pickle, so that nobody can change it and any thread may drop it.
class Kept {
 public:
  explicit Kept(const py::object& object)
      : bytes_(python_name("pickle", "dumps")(object).cast<py::bytes>()) {}
  /// A new copy each time.
  py::object get() const { return python_name("pickle", "loads")(py::bytes(bytes_)); }

 private:
  std::string bytes_;
};

/// lucerna.Estimate.
inline py::object estimate(const Estimate& e) {
  return python_name("lucerna._types", "Estimate")(e.mean, e.standard_error);
}
inline py::object estimate(const std::optional<Estimate>& e) { return e ? estimate(*e) : py::none(); }
inline py::tuple estimates(std::span<const Estimate> all) {
  py::tuple out(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) out[i] = estimate(all[i]);
  return out;
}

inline py::object vector(const std::optional<Vec3>& v) {
  return v ? py::object(vector(*v)) : py::object(py::none());
}

}  // namespace lucerna::python
