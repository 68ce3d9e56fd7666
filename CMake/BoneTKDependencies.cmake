# The packages BoneTK is built on, found once for the whole tree.
include(BoneTKITKModules)

# GDCM's package configuration names programs that Debian ships apart and says so at length; nothing here runs them.
set(_bonetk_loglevel "${CMAKE_MESSAGE_LOG_LEVEL}")
set(CMAKE_MESSAGE_LOG_LEVEL ERROR)
if(NOT BONETK_REMOTE_MODULE)
  find_package(ITK 5.2 REQUIRED COMPONENTS ${BONETK_ITK_COMPONENTS})
endif()
set(CMAKE_MESSAGE_LOG_LEVEL "${_bonetk_loglevel}")
include(BoneTKPackages)

if(BONETK_SANITIZE)
  # Eigen and ITK are not instrumented, which the address sanitizer allows.
  # Checks of each pointer for null, alignment and dynamic type double the compile time; null pointers that are used end
  # the program anyway. GCC's warning of what may be uninitialized is wrong of instrumented code (std::regex).
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null,alignment,vptr -fno-sanitize-recover=undefined
                      -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  add_link_options(-fsanitize=address,undefined)
endif()
