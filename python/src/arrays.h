// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/error.h"
#include "lucerna/geometry.h"

/// All casting between C++ and numpy: another binding library is a change of this header.
namespace lucerna::python {

namespace py = pybind11;

using Shape = std::vector<py::ssize_t>;

inline Shape row(std::size_t n) { return {static_cast<py::ssize_t>(n)}; }
inline Shape grid(std::size_t rows, std::size_t columns) {
  return {static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)};
}

/// A read-only array on memory of `owner`, which it keeps alive. No copy.
template <class T>
py::array_t<T> view(const std::vector<T>& values, const Shape& shape, py::handle owner) {
  py::array_t<T> array(shape, values.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}
template <class T>
py::array_t<T> view(const std::vector<T>& values, py::handle owner) {
  return view(values, row(values.size()), owner);
}

/// A read-only array of shape (n, 3) across three columns that `owner` has, if the second lies as far from
/// the first as the third from the second. No copy.
template <class T>
std::optional<py::array_t<T>> stacked_view(const std::vector<T>& x, const std::vector<T>& y,
                                           const std::vector<T>& z, py::handle owner) {
  const auto place = [](const std::vector<T>& column) {
    return static_cast<py::ssize_t>(reinterpret_cast<std::uintptr_t>(column.data()));
  };
  const py::ssize_t step = place(y) - place(x);
  if (place(z) - place(y) != step || y.size() != x.size() || z.size() != x.size()) return std::nullopt;
  py::array_t<T> array(grid(x.size(), 3), Shape{static_cast<py::ssize_t>(sizeof(T)), step}, x.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// An array that takes the memory of `values` and may be written. No copy.
template <class T>
py::array_t<T> fresh(std::vector<T> values, const Shape& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const T* data = kept->data();
  const py::capsule owner(kept.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<T>(shape, data, owner);
}
template <class T>
py::array_t<T> fresh(std::vector<T> values) {
  const Shape shape = row(values.size());
  return fresh(std::move(values), shape);
}

/// The same, read-only.
template <class T>
py::array_t<T> owned(std::vector<T> values, const Shape& shape) {
  py::array_t<T> array = fresh(std::move(values), shape);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}
template <class T>
py::array_t<T> owned(std::vector<T> values) {
  const Shape shape = row(values.size());
  return owned(std::move(values), shape);
}

inline py::array_t<double> owned(const std::vector<Vec3>& points) {
  std::vector<double> flat;
  flat.reserve(3 * points.size());
  for (const Vec3& p : points) flat.insert(flat.end(), {p.x, p.y, p.z});
  return owned(std::move(flat), grid(points.size(), 3));
}
inline py::tuple vector(const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); }

/// What `np.asarray` makes of an argument. TypeError for what it takes for no array; other exceptions, as
/// KeyboardInterrupt within `__array__`, pass.
inline py::array as_array(const py::handle& given, std::string_view name) {
  try {
    return py::module_::import("numpy").attr("asarray")(given);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
  }
  throw py::type_error(std::string(name) + ": expected an array of numbers");
}

/// What `np.asarray` makes of an argument, as finite numbers of type T in C order. Copies only where type or
/// order ask for it, and raises there if `copy` is false. TypeError for what is no array of numbers.
template <class T>
py::array_t<T, py::array::c_style> input(const py::handle& given, std::string_view name, bool copy = true) {
  const std::string what(name);
  const py::array array = as_array(given, name);
  const char kind = array.dtype().kind();
  if (std::string_view("fiub").find(kind) == std::string_view::npos)
    throw py::type_error(what + ": expected an array of numbers, found dtype " +
                         std::string(py::str(array.dtype())));
  using Target = py::array_t<T, py::array::c_style>;
  const bool fits = Target::check_(array);
  if (!fits && !copy) {
    throw InputError(what + ": found an array that has to be copied (dtype " +
                     std::string(py::str(array.dtype())) + "), expected C-contiguous " +
                     std::string(py::str(py::dtype::of<T>())) + " where copy=False");
  }
  auto out = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!out) throw std::bad_alloc();
  const T* values = out.data();
  for (py::ssize_t i = 0; i < out.size(); ++i) {
    if (!std::isfinite(values[i]))
      throw InputError(what + ": found " + std::to_string(values[i]) + " at index " + std::to_string(i) +
                       ", expected finite numbers");
  }
  return py::reinterpret_borrow<Target>(out);
}

inline std::string shape_text(const py::array& array) { return py::str(array.attr("shape")); }

/// An array of shape (..., 3).
template <class T>
py::array_t<T, py::array::c_style> input_vectors(const py::handle& given, std::string_view name,
                                                 bool copy = true) {
  auto out = input<T>(given, name, copy);
  if (out.ndim() < 1 || out.shape(out.ndim() - 1) != 3)
    throw InputError(std::string(name) + ": found shape " + shape_text(out) + ", expected (..., 3)");
  return out;
}

/// An array of one dimension.
template <class T>
std::vector<T> input_row(const py::handle& given, std::string_view name) {
  const auto out = input<T>(given, name);
  if (out.ndim() != 1)
    throw InputError(std::string(name) + ": found shape " + shape_text(out) + ", expected one dimension");
  return {out.data(), out.data() + out.size()};
}

/// The shape of an array of vectors without its last dimension.
inline Shape shape_of_vectors(const py::array& vectors) {
  return {vectors.shape(), vectors.shape() + vectors.ndim() - 1};
}
inline std::size_t vector_count(const py::array& vectors) {
  return static_cast<std::size_t>(vectors.size() / 3);
}
inline Vec3 vector_at(const double* values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Two arrays of numbers brought to one shape, by numpy's rules.
struct Pair {
  py::array_t<double, py::array::c_style> first, second;
};
inline Pair input_pair(const py::handle& a, std::string_view name_a, const py::handle& b,
                       std::string_view name_b) {
  const auto first = input<double>(a, name_a), second = input<double>(b, name_b);
  const py::tuple both = py::module_::import("numpy").attr("broadcast_arrays")(first, second);
  return {input<double>(both[0], name_a), input<double>(both[1], name_b)};
}
inline Shape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

}  // namespace lucerna::python
