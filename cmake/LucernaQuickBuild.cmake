# SPDX-License-Identifier: Apache-2.0
# What makes building quicker and changes nothing that is built: ccache where it is installed, and precompiled headers of the
# standard library, fmt, Eigen and GoogleTest. The presets dev and clang do without these headers, so that a missing include is found.
# ccache and precompiled headers do not go together; a cache gives more to who builds often.
find_program(LUCERNA_CCACHE ccache)
if(LUCERNA_CCACHE OR CMAKE_CXX_COMPILER_LAUNCHER)
  set(LUCERNA_PRECOMPILED_HEADERS OFF CACHE BOOL "Precompile the headers of other libraries")
else()
  set(LUCERNA_PRECOMPILED_HEADERS ON CACHE BOOL "Precompile the headers of other libraries")
endif()
if(LUCERNA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND NOT LUCERNA_PRECOMPILED_HEADERS)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${LUCERNA_CCACHE}")
endif()

set(lucerna_common_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numbers>
    <numeric> <optional> <span> <string> <string_view> <utility> <variant> <vector> <fmt/format.h> <Eigen/Core>)

# g++ 12 forgets that what it precompiled is the system's, and prints its false alarms about std::string and std::vector
# (GCC bug 105329 and others), which it keeps to itself otherwise. Builds without precompiled headers have these warnings,
# and only they stop at one.
set(lucerna_false_alarms "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(lucerna_false_alarms -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread -Wno-maybe-uninitialized)
endif()

# lucerna_precompile(TARGET PRIVATE HEADERS...) or (TARGET REUSE_FROM OTHER), as target_precompile_headers has it.
function(lucerna_precompile target)
  if(LUCERNA_PRECOMPILED_HEADERS)
    target_compile_options(${target} PRIVATE ${lucerna_false_alarms})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      set_target_properties(${target} PROPERTIES COMPILE_WARNING_AS_ERROR OFF)
    endif()
    target_precompile_headers(${target} ${ARGN})
  endif()
endfunction()
