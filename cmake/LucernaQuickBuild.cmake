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

# lucerna_precompile(TARGET HEADERS...): in files with options of their own they would be of no use.
function(lucerna_precompile target)
  if(LUCERNA_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
