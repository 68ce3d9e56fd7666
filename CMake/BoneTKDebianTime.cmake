# Run by cpack twice: when it begins, and when all files are there. Gives them the time of the commit that they are of, so
# that packages of one commit have the same bytes whenever they are made. SOURCE_DATE_EPOCH, where it is set, goes first.
if("$ENV{SOURCE_DATE_EPOCH}" STREQUAL "")
  find_program(GIT git)
  set(epoch 0)
  if(GIT AND EXISTS ${CPACK_BONETK_SOURCE}/.git)
    execute_process(COMMAND ${GIT} -C ${CPACK_BONETK_SOURCE} log -1 --format=%ct OUTPUT_VARIABLE epoch
                    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  endif()
  set(ENV{SOURCE_DATE_EPOCH} ${epoch})
endif()
if(CPACK_TEMPORARY_DIRECTORY AND EXISTS ${CPACK_TEMPORARY_DIRECTORY})
  execute_process(COMMAND find ${CPACK_TEMPORARY_DIRECTORY} -exec touch --no-dereference --date=@$ENV{SOURCE_DATE_EPOCH} {} +
                  COMMAND_ERROR_IS_FATAL ANY)
endif()
