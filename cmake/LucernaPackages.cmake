# SPDX-License-Identifier: Apache-2.0
# Debian packages (make deb): lucerna (the program), liblucerna0.2 (the shared library), liblucerna-dev (all that compiling needs),
# python3-lucerna (the Python module), lucerna-mpi (the program for many machines).
# LUCERNA_DEBIAN adds what Debian wants in each package's folder of documents; only the preset `deb` sets it.
option(LUCERNA_DEBIAN "Install copyright and changelogs as Debian packages carry them" OFF)
if(NOT LUCERNA_DEBIAN)
  return()
endif()

set(debian_dir "${PROJECT_SOURCE_DIR}/packaging/debian")
file(STRINGS "${debian_dir}/changelog" newest LIMIT_COUNT 1)
string(REGEX MATCH "\\(([0-9.]+)-([0-9]+)\\)" match "${newest}")
if(NOT CMAKE_MATCH_1 STREQUAL PROJECT_VERSION)
  message(FATAL_ERROR "packaging/debian/changelog begins with '${newest}', but this is version ${PROJECT_VERSION}")
endif()
set(debian_version "${PROJECT_VERSION}-${CMAKE_MATCH_2}")
set(library_package "liblucerna${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")

foreach(pair "changelog.Debian.gz|${debian_dir}/changelog" "changelog.gz|${PROJECT_SOURCE_DIR}/CHANGELOG.md")
  string(REPLACE "|" ";" pair "${pair}")
  list(GET pair 0 name)
  list(GET pair 1 source)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}")
  execute_process(COMMAND gzip -9 -n -c "${source}" OUTPUT_FILE "${PROJECT_BINARY_DIR}/${name}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
set(debian_components "program|lucerna" "library|${library_package}" "development|liblucerna-dev")
if(LUCERNA_PYTHON)
  list(APPEND debian_components "python|python3-lucerna")
endif()
if(LUCERNA_MPI)
  list(APPEND debian_components "mpi|lucerna-mpi")
endif()
foreach(pair IN LISTS debian_components)
  string(REPLACE "|" ";" pair "${pair}")
  list(GET pair 0 component)
  list(GET pair 1 package)
  install(FILES "${debian_dir}/copyright" "${PROJECT_BINARY_DIR}/changelog.Debian.gz" "${PROJECT_BINARY_DIR}/changelog.gz"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lucerna)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own as the first line of its description
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program library development)
if(LUCERNA_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(LUCERNA_MPI)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${CMAKE_MATCH_2})
# Who makes the packages answers for them: as Debian's own tools ask for it, DEBFULLNAME and DEBEMAIL.
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(CPACK_DEBIAN_PACKAGE_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The authors of Lucerna <authors@lucerna.invalid>")
  message(STATUS "Debian packages: no maintainer to write to; set DEBFULLNAME and DEBEMAIL before they are given away")
endif()
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lucerna)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "illumination design: from ray file to reflector
Lucerna makes small models of the ray files of light sources, traces
light through mirrors, and designs the mirror that gives a wanted light
distribution.

It reads and writes ray files (TM-25, Zemax, LightTools, SPEOS, ASAP,
MCPL, text), light distributions (IES LM-63, EULUMDAT) and mirrors for CAD
(STEP, STL, OBJ, DXF), and writes reports as HTML.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${library_package})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${debian_dir}/triggers")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "illumination design: shared library
Lucerna makes small models of the ray files of light sources, traces
light through mirrors, and designs the mirror that gives a wanted light
distribution.

This package has the library that programs load.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblucerna-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library_package} (= ${debian_version})")
# What the archive is linked with; programs that use the shared library need none of it.
set(static_packages "libfmt-dev, libtomlplusplus-dev, libtbb-dev, libzstd-dev, libqhull-dev, zlib1g-dev, libssl-dev")
if(embree_FOUND)
  string(APPEND static_packages ", libembree-dev")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "${static_packages}, cmake, pkgconf")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "illumination design: headers and static library
Lucerna makes small models of the ray files of light sources, traces
light through mirrors, and designs the mirror that gives a wanted light
distribution.

This package has what programs in C++20 that use the library are
compiled with: headers, the static library, files for CMake and
pkg-config.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME lucerna-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SUGGESTS "lucerna, openmpi-bin, slurm-client")
set(CPACK_DEBIAN_MPI_DESCRIPTION "illumination design: light tracing on many machines
Lucerna makes small models of the ray files of light sources, traces
light through mirrors, and designs the mirror that gives a wanted light
distribution.

This package has lucerna-mpi, which traces, designs and models sources on
many machines with MPI and writes the files of one process to the byte.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lucerna)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
# The module is of this version of Python and of this very library, which is not installed where the package is made.
math(EXPR next_python "${Python_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${library_package} (= ${debian_version}), python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "lucerna, python3-matplotlib, python3-scipy, python3-xarray")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${debian_dir}/python/postinst;${debian_dir}/python/prerm")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src/lucerna")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "illumination design: Python module
Lucerna makes small models of the ray files of light sources, traces
light through mirrors, and designs the mirror that gives a wanted light
distribution.

This package has the module: import lucerna.")
include(CPack)
