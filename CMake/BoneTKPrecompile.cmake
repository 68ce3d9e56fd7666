# Two precompiled headers for the whole tree: one for the modules' libraries (position-independent code), one with
# GoogleTest for the test programs (position-independent executables, which GCC does not let share the first).
# Nine tenths of what a source of BoneTK is compiled from are ITK's image, Eigen and the standard library.
option(BONETK_PRECOMPILE "Precompile the headers that most sources include" ON)
# A library's sources and a module's tests are compiled twelve at once, bonetk's all: what they instantiate alike is
# instantiated once. A test's names stand in a namespace named after it.
option(BONETK_UNITY_BUILD "Compile several sources of a library or program at once" ON)

function(bonetk_unity_build target sources)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${BONETK_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE ${sources})
endfunction()

# <Eigen/Eigenvalues> stands for that of ITK's own, older Eigen, which its image readers include.
set(BONETK_PRECOMPILED_HEADERS
    <algorithm> <array> <cmath> <cstddef> <functional> <limits> <map> <memory> <ostream> <sstream> <stdexcept> <string>
    <utility> <vector> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <itkImage.h> <itkPointSet.h> <itkProcessObject.h>)

function(bonetk_precompiled_target target)
  bonetk_compile_settings(${target})
  target_include_directories(${target} SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
  target_link_libraries(${target} PRIVATE Eigen3::Eigen Threads::Threads)
  target_precompile_headers(${target} PRIVATE ${BONETK_PRECOMPILED_HEADERS} ${ARGN})
endfunction()

if(BONETK_PRECOMPILE)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cxx CONTENT "int\nmain()\n{}\n")
  add_library(bonePrecompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cxx)
  bonetk_precompiled_target(bonePrecompiled)
  if(BUILD_TESTING)
    add_executable(bonePrecompiledTests EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/precompiled.cxx)
    target_link_libraries(bonePrecompiledTests PRIVATE GTest::gtest GTest::gmock)
    target_compile_options(bonePrecompiledTests PRIVATE ${BONETK_TEST_OPTIONS})
    bonetk_precompiled_target(bonePrecompiledTests <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()

function(bonetk_precompile target)
  if(BONETK_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM bonePrecompiled)
  endif()
endfunction()

function(bonetk_precompile_tests target)
  if(BONETK_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM bonePrecompiledTests)
  endif()
endfunction()
