// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#pragma GCC visibility push(default)
namespace lucerna {

/// What this build of the library is, and what it uses on this processor. Results carry it.
struct BuildInfo {
  /// As `version` has it; and the compiler.
  std::string version, compiler;
  /// The instruction set that traces are made with where none is asked for: "portable", "avx2", "avx512".
  std::string isa;
  /// Threads that a call may use.
  int threads = 1;
  /// Built with Embree, which bodies and the validation of designs need.
  bool embree = false;
  /// Why no CUDA device can be used; empty where one can.
  std::string cuda_unavailable;
};

/// Of the library that is loaded. Thread safe. Looks for CUDA devices at each call.
[[nodiscard]] BuildInfo build_info();

}  // namespace lucerna
#pragma GCC visibility pop
