# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts in place, all of it free of absolute paths: the program with its manual pages and its completion, the
# libraries, include/lucerna, and what finds them (find_package(Lucerna), pkg-config). Target `installable` builds what is needed.
# Components: program, library (the shared one, as programs load it), development.
include(CMakePackageConfigHelpers)

set(manual_dir "${PROJECT_BINARY_DIR}/manual")
find_program(LUCERNA_GZIP gzip)
set(compress_manual COMMAND ${CMAKE_COMMAND} -E true)
if(LUCERNA_GZIP)
  set(compress_manual COMMAND "${LUCERNA_GZIP}" -9 -n -f -r "${manual_dir}/man1")
endif()
add_custom_command(OUTPUT "${manual_dir}/lucerna.bash"
  COMMAND ${CMAKE_COMMAND} -E rm -rf "${manual_dir}/man1"
  COMMAND lucerna_manual "${manual_dir}" ${compress_manual}
  COMMENT "Writing the manual pages" VERBATIM)
add_custom_target(manual ALL DEPENDS "${manual_dir}/lucerna.bash")
add_custom_target(installable)
add_dependencies(installable lucerna_cli manual ${lucerna_libraries})

install(TARGETS lucerna_cli COMPONENT program)
if(LUCERNA_MPI)
  add_dependencies(installable lucerna_mpi)
  install(TARGETS lucerna_mpi COMPONENT mpi)
  set(mpi_manual "${PROJECT_SOURCE_DIR}/packaging/lucerna-mpi.1")
  if(LUCERNA_GZIP)
    execute_process(COMMAND "${LUCERNA_GZIP}" -9 -n -c "${mpi_manual}" OUTPUT_FILE "${PROJECT_BINARY_DIR}/lucerna-mpi.1.gz")
    set(mpi_manual "${PROJECT_BINARY_DIR}/lucerna-mpi.1.gz")
  endif()
  install(FILES "${mpi_manual}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT mpi)
endif()
install(DIRECTORY "${manual_dir}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program)
install(FILES "${manual_dir}/lucerna.bash" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
  RENAME lucerna COMPONENT program)

set(lucerna_package "${CMAKE_INSTALL_LIBDIR}/cmake/Lucerna")
install(TARGETS lucerna EXPORT LucernaStaticTargets COMPONENT development)
install(EXPORT LucernaStaticTargets FILE LucernaTargets-static.cmake NAMESPACE Lucerna::
  DESTINATION "${lucerna_package}" COMPONENT development)
if(LUCERNA_SHARED)
  install(TARGETS lucerna_shared EXPORT LucernaSharedTargets
    LIBRARY COMPONENT library NAMELINK_COMPONENT development)
  install(EXPORT LucernaSharedTargets FILE LucernaTargets-shared.cmake NAMESPACE Lucerna::
    DESTINATION "${lucerna_package}" COMPONENT development)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/lucerna" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development)

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/LucernaConfig.cmake.in" "${PROJECT_BINARY_DIR}/LucernaConfig.cmake"
  INSTALL_DESTINATION "${lucerna_package}")
# No promise between minor versions before 1.0.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/LucernaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/LucernaConfig.cmake" "${PROJECT_BINARY_DIR}/LucernaConfigVersion.cmake"
  DESTINATION "${lucerna_package}" COMPONENT development)

# The prefix as seen from the folder of lucerna.pc.
file(RELATIVE_PATH lucerna_pc_to_prefix "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
string(REGEX REPLACE "/$" "" lucerna_pc_to_prefix "${lucerna_pc_to_prefix}")
set(lucerna_pc_libraries "-lfmt -ltomlplusplus -ltbb -lzstd -lqhull_r -lz -lcrypto")
if(embree_FOUND)
  string(APPEND lucerna_pc_libraries " -lembree3")
endif()
if(LUCERNA_HAS_CUDA)
  string(APPEND lucerna_pc_libraries " -lcudart_static -ldl -lrt")
endif()
configure_file("${CMAKE_CURRENT_LIST_DIR}/lucerna.pc.in" "${PROJECT_BINARY_DIR}/lucerna.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/lucerna.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
