# bonetk_page(<target> <folder>)
#
# Builds the report page's script from <folder> by npm's packages (pinned in its package-lock.json) and compiles it, with
# the page's style sheet and loader, into <target>: see boneReportBundle.h. Without npm, or where npm finds no registry,
# the script is empty, and the page says that it has no interactive view.
option(BONETK_PAGE_BUNDLE "Build the report page's script by npm" ON)
find_program(BONETK_NODE node)
find_program(BONETK_NPM npm)

function(bonetk_page target folder)
  cmake_path(ABSOLUTE_PATH folder)
  set(npm "${BONETK_NPM}")
  if(NOT BONETK_PAGE_BUNDLE)
    set(npm "")
  elseif(NOT BONETK_NODE OR NOT BONETK_NPM)
    set(npm "")
    message(STATUS "The report page has no interactive view: node and npm were not found.")
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/src/*.js)
  list(APPEND sources ${folder}/package.json ${folder}/package-lock.json ${folder}/build.mjs ${folder}/page.css
       ${folder}/loader.js)
  set(script ${PROJECT_SOURCE_DIR}/CMake/BoneTKPageBuild.cmake)
  set(build ${CMAKE_CURRENT_BINARY_DIR}/page)
  # The file's name says whether npm is used, so that a change of it is built.
  set(output ${CMAKE_CURRENT_BINARY_DIR}/boneReportBundle.cxx)
  if(NOT npm)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/boneReportBundleEmpty.cxx)
  endif()
  add_custom_command(OUTPUT ${output}
                     COMMAND ${CMAKE_COMMAND} -D "PAGE=${folder}" -D "BUILD=${build}" -D "OUTPUT=${output}"
                             -D "NODE=${BONETK_NODE}" -D "NPM=${npm}" -P ${script}
                     DEPENDS ${sources} ${script}
                     COMMENT "Bundling the report page's script" VERBATIM)
  target_sources(${target} PRIVATE ${output})
  set_source_files_properties(${output} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
