# What ITK needs to know of BoneTK where it builds it as a remote module (itk-module.cmake): libraries, include folders,
# and the packages that users of these libraries have to find.
list(TRANSFORM BONETK_MODULES_ALL PREPEND bone OUTPUT_VARIABLE BoneTK_LIBRARIES)
foreach(module IN LISTS BONETK_MODULES_ALL)
  bonetk_folders(${PROJECT_SOURCE_DIR}/Modules/${module}/include folders)
  list(APPEND BoneTK_INCLUDE_DIRS ${folders})
endforeach()
set(BoneTK_EXPORT_CODE_INSTALL "
find_package(VTK 9.1 REQUIRED COMPONENTS ${BONETK_VTK_COMPONENTS})
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C CXX)
find_package(Boost REQUIRED)
find_package(Threads REQUIRED)
")
set(BoneTK_EXPORT_CODE_BUILD "
if(NOT ITK_BINARY_DIR)
  ${BoneTK_EXPORT_CODE_INSTALL}
endif()
")
itk_module_impl()

# ITK's own libraries, which find_package(ITK) would name.
set(ITK_LIBRARIES "")
foreach(module IN LISTS BONETK_ITK_COMPONENTS)
  list(APPEND ITK_LIBRARIES ${${module}_LIBRARIES})
endforeach()
list(REMOVE_DUPLICATES ITK_LIBRARIES)
set(ITK_INCLUDE_DIRS "")
