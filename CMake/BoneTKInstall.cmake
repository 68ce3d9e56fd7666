# find_package(BoneTK) for downstream projects, from the installed tree.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/BoneTK)
configure_package_config_file(CMake/BoneTKConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfigVersion.cmake
        CMake/BoneTKPackages.cmake DESTINATION ${config_dir})
install(EXPORT BoneTKTargets NAMESPACE BoneTK:: DESTINATION ${config_dir})
