// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace lucerna::python {

/// What the library throws as Python's exceptions: OSError for files, lucerna.InputError for other input,
/// TypeError for values of a wrong type within an argument, KeyboardInterrupt for a call that was stopped
/// without a result.
void translate_errors();

}  // namespace lucerna::python
