# Writes OUTPUT from INPUT with the version and, where SOURCE_DIR is a git checkout of its own,
# the commit; "+" after it says that files have changed since.
set(COMMIT "")
if(EXISTS ${SOURCE_DIR}/.git)
  find_program(GIT git)
  if(GIT)
    execute_process(
      COMMAND ${GIT} -C ${SOURCE_DIR} describe --always --exclude=* --dirty=+ --abbrev=10
      OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)  # leaves a file alone that would be the same
