// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <typeinfo>

namespace lucerna::python {

namespace py = pybind11;

/// TypeError if `given` is an object of class T, or of one derived from it, that was made by `T.__new__(T)`
/// and never initialised. pybind11 would hand out memory that holds no T.
template <class T>
void check_made(py::handle given) {
  if (!py::isinstance<T>(given)) return;
  auto* instance = reinterpret_cast<py::detail::instance*>(given.ptr());
  const auto held = instance->get_value_and_holder(py::detail::get_type_info(typeid(T)));
  if (held.value_ptr() == nullptr || !held.holder_constructed())
    throw py::type_error(std::string(py::str(py::type::of(given).attr("__name__"))) +
                         ": found an object that was never initialised");
}

/// A caster of pybind11 that takes objects which hold something.
template <class T, class Base>
class MadeCaster : public Base {
 public:
  bool load(py::handle given, bool convert) {
    if (given.is_none()) return false;
    check_made<T>(given);
    return Base::load(given, convert);
  }
};

}  // namespace lucerna::python

// In every source that takes or returns a T: what arguments of the class, or pointers that share it, go
// through.
#define LUCERNA_PYTHON_CLASS(T) \
  template <>                   \
  class pybind11::detail::type_caster<T> : public lucerna::python::MadeCaster<T, type_caster_base<T>> {};
#define LUCERNA_PYTHON_HOLDER(T)                          \
  template <>                                             \
  class pybind11::detail::type_caster<std::shared_ptr<T>> \
      : public lucerna::python::MadeCaster<T, copyable_holder_caster<T, std::shared_ptr<T>>> {};
