# bonetk_module(<Name> [DEPENDS <Module>...] [PUBLIC <lib>...] [PRIVATE <lib>...])
#
# Defines the library BoneTK::<Name> from src/ and include/ (header-only where src holds no source) and, with
# BUILD_TESTING, the test program bone<Name>Tests from test/*Test.cxx; test/*Benchmark.cxx become bone<Name>Benchmarks.
# A dependency that is misspelt, missing, defined later, or against the order of the rooms stops the configuration:
#
#   foundation <- stages <- compositions <- Apps, Examples, Wrapping
#
# The foundation depends on itself alone, and within it only the modules named below may be used by a stage; a
# composition uses foundation, stages and compositions that stand before it.
set(BONETK_FOUNDATION Core IO Phantom Picture Report)
set(BONETK_STAGES Contour Tiling Quality Density Simplification Radiograph Atlas)
set(BONETK_COMPOSITIONS Model Evaluation Registration Measurement Export)
set(BONETK_MODULES_ALL ${BONETK_FOUNDATION} ${BONETK_STAGES} ${BONETK_COMPOSITIONS})
set(BONETK_STAGES_MAY_USE Core)
set(bonetk_include_dir ${CMAKE_INSTALL_INCLUDEDIR}/BoneTK)
if(BONETK_REMOTE_MODULE)
  set(bonetk_include_dir ${ITK_INSTALL_INCLUDE_DIR})
endif()

function(bonetk_compile_settings target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
  if(BONETK_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# A test's own code is compiled in half the time with few optimisations, with which GCC sees less of what is initialised;
# the libraries have all of theirs. The header that is precompiled for tests has to have the same options.
set(BONETK_TEST_OPTIONS $<$<CONFIG:Release>:-O1> $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
function(bonetk_test_settings target)
  bonetk_compile_settings(${target})
  target_compile_options(${target} PRIVATE ${BONETK_TEST_OPTIONS})
  bonetk_precompile_tests(${target})
  bonetk_unity_build(${target} 12)
endfunction()

# Registers a test program's tests in as many parts as it has sources, not one by one: under the sanitizers a process takes
# longer to load its libraries than most tests to run.
function(bonetk_shard_tests target name)
  get_target_property(sources ${target} SOURCES)
  list(LENGTH sources shards)
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME ${name}.part_${shard} COMMAND ${target} --gtest_brief=1)
    set_tests_properties(${name}.part_${shard} PROPERTIES LABELS unit TIMEOUT 600
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

# Refuses an unnamed namespace in a test: others that are compiled with it would call what it holds, unseen.
function(bonetk_check_names)
  foreach(test IN LISTS ARGN)
    file(STRINGS ${test} unnamed REGEX "^namespace( *{)?$")
    if(unnamed)
      message(FATAL_ERROR "${test}: the namespace needs a name, that of the test with an s.")
    endif()
  endforeach()
endfunction()

# Refuses a dependency against the order of the rooms.
function(bonetk_check_dependency name dependency)
  if(NOT TARGET bone${dependency})
    message(FATAL_ERROR "Module ${name} depends on ${dependency}, which is no module standing before it.")
  endif()
  if(name IN_LIST BONETK_FOUNDATION)
    set(allowed ${BONETK_FOUNDATION})
  elseif(name IN_LIST BONETK_STAGES)
    set(allowed ${BONETK_STAGES_MAY_USE})
  elseif(name IN_LIST BONETK_COMPOSITIONS)
    set(allowed ${BONETK_MODULES_ALL})
  else()
    message(FATAL_ERROR "Module ${name} is in no room: name it in CMake/BoneTKModule.cmake.")
  endif()
  if(NOT dependency IN_LIST allowed)
    message(FATAL_ERROR "Module ${name} may not depend on ${dependency}; it may use: ${allowed}.")
  endif()
endfunction()

# A folder and the folders in it.
function(bonetk_folders folder result)
  cmake_path(ABSOLUTE_PATH folder)
  file(GLOB inner LIST_DIRECTORIES true CONFIGURE_DEPENDS ${folder}/*)
  list(FILTER inner EXCLUDE REGEX "\\.[a-z]+$")
  set(${result} ${folder} ${inner} PARENT_SCOPE)
endfunction()

function(bonetk_module name)
  cmake_parse_arguments(arg "" "" "DEPENDS;PUBLIC;PRIVATE" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "bonetk_module(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  foreach(dependency IN LISTS arg_DEPENDS)
    bonetk_check_dependency(${name} ${dependency})
  endforeach()

  # Folders in src and include name a concern each; their headers are found from all of them, and installed into one.
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS src/*.cxx)
  bonetk_folders(src concerns)
  bonetk_folders(include include_dirs)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS include/*.h include/*.hxx)
  set(target bone${name})
  if(sources)
    add_library(${target} STATIC ${sources} ${headers})
    set(scope PUBLIC)
    bonetk_compile_settings(${target})
    target_include_directories(${target} PRIVATE ${concerns})
    bonetk_precompile(${target})
    bonetk_unity_build(${target} 12)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(BoneTK::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} ${scope}
                             "$<BUILD_INTERFACE:${include_dirs}>"
                             $<INSTALL_INTERFACE:${bonetk_include_dir}>)
  list(TRANSFORM arg_DEPENDS PREPEND bone)
  target_link_libraries(${target} ${scope} ${arg_DEPENDS} ${arg_PUBLIC})
  if(sources)
    target_link_libraries(${target} PRIVATE ${arg_PRIVATE})
  endif()
  if(BONETK_REMOTE_MODULE)
    itk_module_target(${target})
  else()
    install(TARGETS ${target} EXPORT BoneTKTargets
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  endif()
  install(FILES ${headers} DESTINATION ${bonetk_include_dir} COMPONENT development)

  file(GLOB tests CONFIGURE_DEPENDS test/*Test.cxx)
  if(BUILD_TESTING AND tests)
    bonetk_check_names(${tests})
    add_executable(${target}Tests ${tests})
    bonetk_test_settings(${target}Tests)
    # Kernels that are not installed are tested too.
    target_include_directories(${target}Tests PRIVATE ${concerns})
    target_link_libraries(${target}Tests PRIVATE ${target} GTest::gtest_main GTest::gmock)
    if(BONETK_SANITIZE)
      bonetk_shard_tests(${target}Tests ${name})
    else()
      gtest_discover_tests(${target}Tests TEST_PREFIX "${name}." PROPERTIES LABELS unit DISCOVERY_TIMEOUT 60)
    endif()
  endif()
  file(GLOB benchmarks CONFIGURE_DEPENDS test/*Benchmark.cxx)
  if(BONETK_BUILD_BENCHMARKS AND benchmarks)
    add_executable(${target}Benchmarks ${benchmarks})
    bonetk_compile_settings(${target}Benchmarks)
    target_include_directories(${target}Benchmarks PRIVATE ${concerns})
    target_link_libraries(${target}Benchmarks PRIVATE ${target} benchmark::benchmark_main)
  endif()
endfunction()
