# `cpack` in the build directory makes two Debian packages: plumbline, the programs with what they
# need, and libplumbline-dev, headers and static libraries. Their dependencies are found out by
# dpkg-shlibdeps.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME plumbline)
set(CPACK_PACKAGE_VENDOR "The plumbline developers")
set(CPACK_PACKAGE_CONTACT "The plumbline developers <developers@plumbline.invalid>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)

set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME plumbline)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION
"maps building interiors in 3D from 2D laser scanners
Maps the inside of buildings from the scan lines of several 2D laser scanners
on one moving rig, without an inertial sensor, and states how precise the map
is. It estimates together the trajectory of the rig in six degrees of freedom
and the surfaces of the building with their covariances.

plumbline_check tells before mapping what is wrong with a recording or its rig
file, plumbline_map makes the map, plumbline_calibrate finds the rig from several
recordings, plumbline_report shows it in a browser,
plumbline_plan draws floor plans with rooms, doors and areas, plumbline_export
converts points. plumbline_simulate makes recordings, plumbline_evaluate holds
maps against the truth, plumbline_bound says how precise a map can be at best.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "bash-completion, man-db, libplumbline-dev")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libplumbline-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"maps building interiors in 3D from 2D laser scanners - libraries
Headers, static libraries and the CMake package of plumbline, which maps the
inside of buildings from the scan lines of several 2D laser scanners.")
plumbline_get_dependencies(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS CORE DEBIAN ", ")
# Only who asks CMake for the component `simulation` needs these.
plumbline_get_dependencies(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS SIMULATION DEBIAN ", ")

# What every Debian package has: its licence, and what changed.
find_program(GZIP gzip REQUIRED)
configure_file(scripts/packaging/cmake/debian_changelog.in ${PROJECT_BINARY_DIR}/debian/changelog @ONLY)
set(PLUMBLINE_DEBIAN_CHANGELOG ${PROJECT_BINARY_DIR}/debian/changelog.gz)
add_custom_command(OUTPUT ${PLUMBLINE_DEBIAN_CHANGELOG}
  COMMAND ${GZIP} -9nc ${PROJECT_BINARY_DIR}/debian/changelog > ${PLUMBLINE_DEBIAN_CHANGELOG}
  DEPENDS ${PROJECT_BINARY_DIR}/debian/changelog
  COMMENT "" VERBATIM)
add_custom_target(plumbline_debian_changelog ALL DEPENDS ${PLUMBLINE_DEBIAN_CHANGELOG})
foreach(component runtime development)
  string(TOUPPER ${component} key)
  set(directory ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${key}_PACKAGE_NAME})
  install(FILES ${PLUMBLINE_DEBIAN_CHANGELOG}
    DESTINATION ${directory} COMPONENT ${component})
  install(FILES ${PROJECT_SOURCE_DIR}/scripts/packaging/cmake/debian_copyright RENAME copyright
    DESTINATION ${directory} COMPONENT ${component})
endforeach()
include(CPack)
