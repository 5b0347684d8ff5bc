# SPDX-License-Identifier: Apache-2.0
# One place for the warnings; whether they are errors is the preset's choice (CMAKE_COMPILE_WARNING_AS_ERROR),
# so that a stranger's newer compiler never stops a stranger's build.
# Designated initialisers are meant to leave the rest at its default: no -Wmissing-field-initializers.
add_library(lucerna_warnings INTERFACE)
target_compile_options(lucerna_warnings INTERFACE
  "$<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wpedantic;-Wconversion;-Wno-sign-conversion;-Wnon-virtual-dtor>"
  "$<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual;-Wcast-qual;-Wundef;-Wno-missing-field-initializers>"
  # In a unity build a local name may be one that another source has for itself: builds of each source alone have this warning.
  "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<BOOL:${LUCERNA_UNITY}>>>:-Wshadow>"
  # clang warns of every float that meets a double, also where a double is asked for.
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wdouble-promotion>)

# The same bits for every optimisation level and compiler: no contraction of a * b + c behind our back.
add_library(lucerna_numerics INTERFACE)
target_compile_options(lucerna_numerics INTERFACE
  "$<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>" "$<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-ffp-contract=off>")
