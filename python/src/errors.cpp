// SPDX-License-Identifier: Apache-2.0
#include "errors.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "lucerna/error_parts.h"
#include "record.h"

namespace lucerna::python {

namespace {

namespace fs = std::filesystem;

/// The errno of an error about a file; 0 for other errors.
int file_error(ErrorCause cause, const fs::path& path) {
  std::error_code none;
  switch (cause) {
    case ErrorCause::not_found:
      return ENOENT;
    case ErrorCause::no_space:
      return ENOSPC;
    case ErrorCause::unreadable:
      if (fs::is_directory(path, none)) return EISDIR;
      return ::access(path.c_str(), R_OK) == 0 ? EIO : errno;
    case ErrorCause::unwritable: {
      if (fs::is_directory(path, none)) return EISDIR;
      const fs::path folder = fs::absolute(path, none).parent_path();
      if (::access(folder.c_str(), F_OK) != 0) return errno;
      if (!fs::is_directory(folder, none)) return ENOTDIR;
      if (::access(folder.c_str(), W_OK) != 0) return errno;
      // A name that is too long, a loop of links.
      return ::access(path.c_str(), F_OK) == 0 || errno == ENOENT ? EIO : errno;
    }
    default:
      return 0;
  }
}

/// Text that may name a file: bytes that are no UTF-8 become what `os.fsdecode` makes of them.
py::object decoded(const std::string& text) {
  const auto size = static_cast<Py_ssize_t>(text.size());
  auto out = py::reinterpret_steal<py::object>(PyUnicode_DecodeFSDefaultAndSize(text.data(), size));
  if (!out) throw py::error_already_set();
  return out;
}
py::object or_none(const std::string& text) { return text.empty() ? py::object(py::none()) : decoded(text); }

void set_error(const Error& error) {
  const ErrorParts parts = error_parts(error);
  const std::string text = error.what();
  if (const int number = file_error(error.cause(), parts.path); number != 0) {
    const std::string without_path = parts.path.empty() ? text : text.substr(parts.path.size() + 2);
    const py::object made =
        py::reinterpret_borrow<py::object>(PyExc_OSError)(number, decoded(without_path), decoded(parts.path));
    PyErr_SetObject(py::type::of(made).ptr(), made.ptr());
    return;
  }
  using namespace py::literals;
  const py::object type = python_name("lucerna._types", "InputError");
  const py::object made =
      type(decoded(text), "path"_a = or_none(parts.path), "place"_a = or_none(parts.place),
           "found"_a = or_none(parts.found), "expected"_a = or_none(parts.expected),
           "cause"_a = std::string(to_string(error.cause())));
  PyErr_SetObject(type.ptr(), made.ptr());
}

}  // namespace

void translate_errors() {
  // pybind11 wants a function of this type. NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const Error& error) {
      set_error(error);
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError, "found a value of a wrong type within an argument");
    } catch (const fs::filesystem_error& error) {
      PyErr_SetObject(
          PyExc_OSError,
          py::make_tuple(error.code().value(), decoded(error.what()), decoded(error.path1().string())).ptr());
    }
  });
}

}  // namespace lucerna::python
