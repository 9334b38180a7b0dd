# find_package(haarlight) for a consumer project.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/haarlight)
install(EXPORT haarlightTargets NAMESPACE haarlight:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/haarlightConfig.cmake.in
  ${CMAKE_BINARY_DIR}/haarlightConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/haarlightConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/haarlightConfig.cmake ${CMAKE_BINARY_DIR}/haarlightConfigVersion.cmake
        ${CMAKE_CURRENT_LIST_DIR}/Dependencies.cmake DESTINATION ${package_dir})
