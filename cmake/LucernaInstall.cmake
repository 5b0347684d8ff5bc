# SPDX-License-Identifier: Apache-2.0
# The library for others: include/lucerna, the archive, and a package that find_package(Lucerna) finds, with target Lucerna::lucerna.
include(CMakePackageConfigHelpers)
set(lucerna_package "${CMAKE_INSTALL_LIBDIR}/cmake/Lucerna")
install(TARGETS lucerna EXPORT LucernaTargets)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/lucerna" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT LucernaTargets NAMESPACE Lucerna:: DESTINATION "${lucerna_package}")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/LucernaConfig.cmake.in" "${PROJECT_BINARY_DIR}/LucernaConfig.cmake"
  INSTALL_DESTINATION "${lucerna_package}")
# No promise between minor versions before 1.0.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/LucernaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/LucernaConfig.cmake" "${PROJECT_BINARY_DIR}/LucernaConfigVersion.cmake"
  DESTINATION "${lucerna_package}")
