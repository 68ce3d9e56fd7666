# What ITK needs to know of BoneTK where it builds it as a remote module (itk-module.cmake): libraries, include folders,
# and the packages that users of these libraries have to find.
list(TRANSFORM BONETK_MODULES_ALL PREPEND bone OUTPUT_VARIABLE BoneTK_LIBRARIES)
foreach(module IN LISTS BONETK_MODULES_ALL)
  bonetk_folders(${PROJECT_SOURCE_DIR}/Modules/${module}/include folders)
  list(APPEND BoneTK_INCLUDE_DIRS ${folders})
endforeach()
file(READ ${CMAKE_CURRENT_LIST_DIR}/BoneTKPackages.cmake BoneTK_EXPORT_CODE_INSTALL)
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
