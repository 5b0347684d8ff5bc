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
      return ::access(path.c_str(), R_OK) == 0 ? EIO : EACCES;
    case ErrorCause::unwritable: {
      if (fs::is_directory(path, none)) return EISDIR;
      const fs::path folder = fs::absolute(path, none).parent_path();
      if (!fs::exists(folder, none)) return ENOENT;
      if (!fs::is_directory(folder, none)) return ENOTDIR;
      return ::access(folder.c_str(), W_OK) == 0 ? EIO : EACCES;
    }
    default:
      return 0;
  }
}

py::object or_none(const std::string& text) {
  return text.empty() ? py::object(py::none()) : py::object(py::str(text));
}

void set_error(const Error& error) {
  const ErrorParts parts = error_parts(error);
  const std::string text = error.what();
  if (const int number = file_error(error.cause(), parts.path); number != 0) {
    const std::string without_path = parts.path.empty() ? text : text.substr(parts.path.size() + 2);
    const py::object made =
        py::reinterpret_borrow<py::object>(PyExc_OSError)(number, without_path, parts.path);
    PyErr_SetObject(py::type::of(made).ptr(), made.ptr());
    return;
  }
  using namespace py::literals;
  const py::object type = python_name("lucerna._types", "InputError");
  const py::object made = type(text, "path"_a = or_none(parts.path), "place"_a = or_none(parts.place),
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
      PyErr_SetObject(PyExc_OSError,
                      py::make_tuple(error.code().value(), error.what(), error.path1().string()).ptr());
    }
  });
}

}  // namespace lucerna::python
