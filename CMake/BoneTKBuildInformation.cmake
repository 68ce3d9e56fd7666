# bonetk_build_information(<target>)
#
# Adds GetBuildInformation() to <target> (boneBuildInformation.h), in a source of its own that is written at each build and
# compiled where it has changed: a commit compiles no more than that. The commit is git's, where the sources are in a
# repository of their own, or BONETK_COMMIT, or unknown.
#
# With -P this file writes that source, OUTPUT.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(BONETK_COMMIT "" CACHE STRING "Commit that the program says it is of; empty: git's")
  find_package(Git QUIET)

  function(bonetk_build_information target)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/boneBuildInformationValues.cxx)
    add_custom_target(boneBuildInformation BYPRODUCTS ${output}
      COMMAND ${CMAKE_COMMAND} -D "SOURCE=${PROJECT_SOURCE_DIR}" -D "GIT=${GIT_EXECUTABLE}" -D "COMMIT=${BONETK_COMMIT}"
              -D "VERSION=${PROJECT_VERSION}" -D "COMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
              -D "CONFIGURATION=$<CONFIG>" -D "OUTPUT=${output}"
              -P ${PROJECT_SOURCE_DIR}/CMake/BoneTKBuildInformation.cmake
      VERBATIM COMMENT "Finding the commit")
    target_sources(${target} PRIVATE ${output})
    set_source_files_properties(${output} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
    add_dependencies(${target} boneBuildInformation)
  endfunction()
endif()

# Sets <commit>, <date> and <changed> of the repository at SOURCE; all empty, and false, where there is none.
function(bonetk_find_commit commit date changed)
  set(${commit} "${COMMIT}" PARENT_SCOPE)
  set(${date} "" PARENT_SCOPE)
  set(${changed} false PARENT_SCOPE)
  # An archive that lies in another project's repository is none of its commits.
  if(COMMIT OR NOT GIT OR NOT EXISTS ${SOURCE}/.git)
    return()
  endif()
  execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} log -1 --abbrev=12 --format=%h|%cs
                  OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
  if(failed OR NOT found MATCHES "^([0-9a-f]+)\\|([0-9-]+)$")
    return()
  endif()
  set(${commit} ${CMAKE_MATCH_1} PARENT_SCOPE)
  set(${date} ${CMAKE_MATCH_2} PARENT_SCOPE)
  execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} diff --quiet HEAD RESULT_VARIABLE differs)
  if(differs)
    set(${changed} true PARENT_SCOPE)
  endif()
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)
  bonetk_find_commit(commit date changed)
  file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "boneBuildInformation.h"

namespace bone
{
const BuildInformation &
GetBuildInformation()
{
  static const BuildInformation build{ "@VERSION@", "@commit@", "@date@", @changed@, "@COMPILER@", "@CONFIGURATION@" };
  return build;
}
} // namespace bone
]])
endif()
