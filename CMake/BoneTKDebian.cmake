# Debian packages of what is installed, one a component: cmake --preset package && cmake --build --preset package, then
# cpack in build/package. What a program or the Python package needs is found out from its libraries (dpkg-shlibdeps).
# Run twice, it writes the same bytes: files have the time of the commit, or that of SOURCE_DATE_EPOCH.
set(BONETK_MAINTAINER "The BoneTK contributors <maintainers@bonetk.invalid>" CACHE STRING "Maintainer of packages")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME bonetk)
set(CPACK_PACKAGE_VENDOR "")
set(CPACK_PACKAGE_CONTACT "${BONETK_MAINTAINER}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};BoneTK;ALL;/")
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/BoneTKDebianTime.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/BoneTKDebianTime.cmake)
set(CPACK_BONETK_SOURCE ${PROJECT_SOURCE_DIR})

set(CPACK_COMPONENTS_ALL program development documentation)
if(TARGET bonePython)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# bonetk_debian_package(<component> <package> SECTION <section> TEXT <lines> [SHLIBS] [ALL] [DEPENDS <package>...])
#
# SHLIBS: it holds programs, and depends on their libraries. ALL: the same for all machines.
function(bonetk_debian_package component package)
  cmake_parse_arguments(arg "SHLIBS;ALL" "SECTION;TEXT" "DEPENDS" ${ARGN})
  string(TOUPPER ${component} name)
  list(JOIN arg_DEPENDS ", " depends)
  set(CPACK_DEBIAN_${name}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${name}_PACKAGE_SECTION ${arg_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${name}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${name}_PACKAGE_SHLIBDEPS ${arg_SHLIBS} PARENT_SCOPE)
  set(CPACK_DEBIAN_${name}_DESCRIPTION "${arg_TEXT}" PARENT_SCOPE)
  if(arg_ALL)
    set(CPACK_DEBIAN_${name}_PACKAGE_ARCHITECTURE all PARENT_SCOPE)
  endif()
endfunction()

bonetk_debian_package(program bonetk SECTION science SHLIBS DEPENDS fonts-dejavu-core
  TEXT "The program: turns CT scans of bones into layered tetrahedral meshes
with polynomial densities, simplifies them, makes radiographs and
statistical atlases of them, and finds them in X-rays.")
# What BoneTK's libraries are built on, their users need: of the packages that the build needs those of C++ libraries, but
# for what tests, the program and Python need.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/debian-packages.txt libraries REGEX "-dev$")
list(FILTER libraries EXCLUDE REGEX "^(libgtest|libgmock|libbenchmark|libcli11|python3|pybind11)-dev$")
bonetk_debian_package(development libbonetk-dev SECTION libdevel DEPENDS ${libraries} pkg-config
  TEXT "Headers, static libraries and CMake configuration of the C++ toolkit,
in the style of ITK: contours, tiling, mesh quality, density,
simplification, radiographs, atlases, registration.")
bonetk_debian_package(documentation bonetk-doc SECTION doc ALL
  TEXT "Guide, file formats, pages of the modules, what was measured, and
example programs.")
if(TARGET bonePython)
  get_directory_property(minor DIRECTORY ${PROJECT_SOURCE_DIR}/Wrapping/Python DEFINITION Python_VERSION_MINOR)
  math(EXPR next "${minor} + 1")
  bonetk_debian_package(python python3-bonetk SECTION python SHLIBS
    DEPENDS "python3 (>= 3.${minor}~)" "python3 (<< 3.${next}~)" python3-numpy fonts-dejavu-core
    TEXT "The Python package: the commands of bonetk as functions, and meshes,
atlases and filters on NumPy arrays.")
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS bonetk-doc)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "bonetk-doc, python3-nibabel, python3-vtk9")

include(CPack)
