# bonetk_install_copyright(<component> <package>)
#
# Installs the licence as share/doc/<package>/copyright, where Debian wants it, with those of what is compiled in: the
# packages of the page's script, and libraries that are headers alone.
#
# With -P this file writes OUTPUT from LICENSE, SCRIPT (the page's script, which ends in licences) and HEADERS (packages).
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(bonetk_copyright ${CMAKE_CURRENT_LIST_FILE})

  function(bonetk_install_copyright component package)
    set(output ${PROJECT_BINARY_DIR}/copyright)
    install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" -D \"OUTPUT=${output}\"
      -D \"LICENSE=${PROJECT_SOURCE_DIR}/LICENSE\" -D \"SCRIPT=${PROJECT_BINARY_DIR}/Modules/Report/page/bundle.js\"
      -D \"HEADERS=libcli11-dev;libeigen3-dev;nlohmann-json3-dev;pybind11-dev\" -P \"${bonetk_copyright}\"
      COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
    install(FILES ${output} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  endfunction()
  return()
endif()

cmake_minimum_required(VERSION 3.25)
set(line "\n----------------------------------------------------------------------------------------------------\n\n")
set(text "BoneTK: copyright the BoneTK contributors. Its licence, Apache-2.0, follows, and then those of what is compiled\n\
into it.\n${line}")
file(READ ${LICENSE} licence)
string(APPEND text "${licence}")
foreach(package IN LISTS HEADERS)
  if(EXISTS /usr/share/doc/${package}/copyright)
    file(READ /usr/share/doc/${package}/copyright licence)
    string(APPEND text "${line}${package}, as Debian states it:\n\n${licence}")
  endif()
endforeach()
if(EXISTS ${SCRIPT})
  file(READ ${SCRIPT} script)
  string(FIND "${script}" "/*! This script holds:" begin REVERSE)
  if(begin GREATER_EQUAL 0)
    string(SUBSTRING "${script}" ${begin} -1 licences)
    string(REGEX REPLACE "^/\\*! This script holds:|\\*/[ \n]*$" "" licences "${licences}")
    string(APPEND text "${line}The script of report pages holds:${licences}")
  endif()
endif()
file(WRITE ${OUTPUT} "${text}")
