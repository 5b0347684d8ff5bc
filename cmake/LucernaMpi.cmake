# SPDX-License-Identifier: Apache-2.0
# The program for many machines, lucerna-mpi: where an MPI library with its compiler wrapper is installed (libopenmpi-dev or
# libmpich-dev). Of several, -DMPI_CXX_COMPILER=mpicxx.mpich -DMPIEXEC_EXECUTABLE=/usr/bin/mpiexec.mpich chooses.
find_package(MPI COMPONENTS CXX QUIET)
set(lucerna_mpi_default ${MPI_CXX_FOUND})
if(NOT PROJECT_IS_TOP_LEVEL OR CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  set(lucerna_mpi_default OFF)
endif()
option(LUCERNA_MPI "Build lucerna-mpi (needs an MPI library)" ${lucerna_mpi_default})
option(LUCERNA_MPI_TESTS "Test it under mpirun, for some minutes (make test-mpi)" OFF)
if(LUCERNA_MPI AND NOT MPI_CXX_FOUND)
  message(FATAL_ERROR "LUCERNA_MPI is on, but no MPI library was found")
endif()
if(LUCERNA_MPI)
  message(STATUS "MPI: ${MPI_CXX_LIBRARIES} (${MPIEXEC_EXECUTABLE})")
else()
  message(STATUS "MPI: off; lucerna-mpi is not built (scripts/packages-mpi.txt)")
endif()
