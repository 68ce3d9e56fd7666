# BoneTK as a remote module of ITK 5.2 or later: put the project into ITK's Modules/Remote/BoneTK and configure ITK with
# Module_BoneTK=ON. It builds the libraries; bonetk, examples and tests are built by the project's own configuration.
include(${CMAKE_CURRENT_LIST_DIR}/CMake/BoneTKITKModules.cmake)
itk_module(BoneTK
  DEPENDS ${BONETK_ITK_COMPONENTS}
  EXCLUDE_FROM_DEFAULT
  DESCRIPTION "Bone density models from CT, after Yao and Taylor")
