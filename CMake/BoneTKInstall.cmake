# What is installed, by component:
#
#   program        bonetk, its manual pages and completions (Apps)
#   development    headers, libraries, find_package(BoneTK) (here, and BoneTKModule.cmake)
#   python         the package bonetk (Wrapping/Python)
#   documentation  guide, pages of the modules, example programs (here)
include(CMakePackageConfigHelpers)
include(BoneTKCopyright)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/BoneTK)
configure_package_config_file(CMake/BoneTKConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/BoneTKConfigVersion.cmake
              CMake/BoneTKPackages.cmake
        DESTINATION ${config_dir} COMPONENT development)
install(EXPORT BoneTKTargets NAMESPACE BoneTK:: DESTINATION ${config_dir} COMPONENT development)

# In the source tree's layout, so that links between the pages hold.
set(doc_dir ${CMAKE_INSTALL_DATADIR}/doc/bonetk-doc)
install(FILES README.md CHANGELOG.md DESTINATION ${doc_dir} COMPONENT documentation)
install(DIRECTORY Documentation Examples DESTINATION ${doc_dir} COMPONENT documentation USE_SOURCE_PERMISSIONS
        PATTERN site EXCLUDE PATTERN __pycache__ EXCLUDE)
file(GLOB pages CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
     Modules/*/README.md Testing/*/README.md Wrapping/*/README.md)
foreach(page IN LISTS pages)
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${page} DESTINATION ${doc_dir}/${folder} COMPONENT documentation)
endforeach()

foreach(package IN ITEMS program:bonetk development:libbonetk-dev python:python3-bonetk documentation:bonetk-doc)
  string(REPLACE ":" ";" package ${package})
  bonetk_install_copyright(${package})
endforeach()

# cmake --build build/release --target site
add_custom_target(site COMMAND ${PROJECT_SOURCE_DIR}/Documentation/site/make.sh ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/site
                  COMMENT "Documentation: ${PROJECT_BINARY_DIR}/site/html/index.html" USES_TERMINAL VERBATIM)
