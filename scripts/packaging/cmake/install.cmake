# What `cmake --install` puts where. Components: `runtime`, the programs and what they need, and
# `development`, headers and libraries for other projects.

include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)

# Installs a library of plumbline_add_library with its headers. Rooms of simulation/ need more
# libraries of others, so they are a component of the CMake package that has to be asked for.
function(plumbline_install_library name)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT folder MATCHES "^(factors|core|simulation)/")
    return()
  endif()
  string(REGEX REPLACE "^plumbline_" "" exported ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${exported})
  add_library(plumbline::${exported} ALIAS ${name})
  set(export_set plumblineTargets)
  set(part CORE)
  if(folder MATCHES "^simulation/")
    set(export_set plumblineSimulationTargets)
    set(part SIMULATION)
  endif()
  plumbline_note_dependencies(${name} ${part})
  install(TARGETS ${name} EXPORT ${export_set}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/plumbline COMPONENT development)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  install(FILES ${headers}
    DESTINATION ${PLUMBLINE_INSTALL_HEADERS}/${folder} COMPONENT development)
endfunction()

# Installs a program with the man page and the completion for bash that are made from its flags.
function(plumbline_install_app name)
  install(TARGETS ${name} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  set(script ${PROJECT_SOURCE_DIR}/scripts/packaging/flag_pages.py)
  set(man_page ${PROJECT_BINARY_DIR}/share/man/man1/${name}.1.gz)
  set(completion ${PROJECT_BINARY_DIR}/share/bash-completion/completions/${name})
  add_custom_command(OUTPUT ${man_page} ${completion}
    COMMAND ${Python3_EXECUTABLE} ${script} $<TARGET_FILE:${name}>
      --man=${man_page} --completion=${completion}
    DEPENDS ${name} ${script}
    COMMENT "Making the man page and the completion of ${name}"
    VERBATIM)
  add_custom_target(${name}_pages ALL DEPENDS ${man_page} ${completion})
  install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
  install(FILES ${completion}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
endfunction()

# The CMake package, after all libraries.
function(plumbline_install_package)
  include(CMakePackageConfigHelpers)
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/plumbline)
  foreach(export_set plumblineTargets plumblineSimulationTargets)
    install(EXPORT ${export_set}
      NAMESPACE plumbline:: DESTINATION ${destination} COMPONENT development)
  endforeach()
  plumbline_get_dependencies(PLUMBLINE_FIND_CORE CORE CMAKE "\n")
  plumbline_get_dependencies(PLUMBLINE_FIND_SIMULATION SIMULATION CMAKE "\n  ")
  configure_package_config_file(${PROJECT_SOURCE_DIR}/scripts/packaging/cmake/plumblineConfig.cmake.in
    ${PROJECT_BINARY_DIR}/plumblineConfig.cmake
    INSTALL_DESTINATION ${destination}
    NO_SET_AND_CHECK_MACRO
    NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  # While the version begins with 0, any of them may change what an earlier one offers.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES
      ${PROJECT_BINARY_DIR}/plumblineConfig.cmake
      ${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
    DESTINATION ${destination} COMPONENT development)
endfunction()

# Settings and pages, beside each other as in the source, so that links between them hold. Commands
# of the pages are those of whoever has installed them: programs by their names, shipped files by
# where they lie.
function(plumbline_install_data)
  set(data ${CMAKE_INSTALL_DATADIR}/plumbline)
  install(DIRECTORY configs docs DESTINATION ${data} COMPONENT runtime)
  install(FILES README.md CHANGELOG.md CITATION.cff LICENSE
    DESTINATION ${data} COMPONENT runtime)
  install(SCRIPT ${PROJECT_SOURCE_DIR}/scripts/packaging/cmake/installed_pages.cmake
    COMPONENT runtime)
endfunction()
