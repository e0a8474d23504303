# The libraries of others that ours link: who links ours needs them too. A row has the name by which
# a CMakeLists.txt links it, what makes that name known in plumblineConfig.cmake (nothing for plain
# names, which the linker knows), and the Debian package.
set(PLUMBLINE_DEPENDENCIES
  "BZip2::BZip2|find_dependency(BZip2)|libbz2-dev"
  "Boost::headers|find_dependency(Boost)|libboost-dev"
  "CGAL::CGAL|find_dependency(CGAL)|libcgal-dev"
  "Ceres::ceres|find_dependency(Ceres)|libceres-dev"
  "Eigen3::Eigen|find_dependency(Eigen3)|libeigen3-dev"
  "PkgConfig::LIBDEFLATE|find_dependency(PkgConfig)
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate)|libdeflate-dev, pkgconf"
  "SQLite::SQLite3|find_dependency(SQLite3)|libsqlite3-dev"
  "TBB::tbb|find_dependency(TBB)|libtbb-dev"
  "boost_system||libboost-system-dev"
  "console_bridge||libconsole-bridge-dev"
  "cpp_common||libroscpp-core-dev"
  "glog::glog|find_dependency(glog)|libgoogle-glog-dev"
  "lz4||liblz4-dev"
  "nlohmann_json::nlohmann_json|find_dependency(nlohmann_json)|nlohmann-json3-dev"
  "pcl_common||libpcl-dev"
  "pcl_io||libpcl-dev"
  "rosbag_storage||librosbag-storage-dev"
  "roscpp_serialization||libroscpp-core-dev"
  "rostime||libroscpp-core-dev"
  "yaml-cpp|find_dependency(yaml-cpp)|libyaml-cpp-dev"
  "zstd||libzstd-dev"
)

# Notes what a library of plumbline_add_library links, for the CMake package and the Debian package:
# adds to the global properties PLUMBLINE_<part>_CMAKE and PLUMBLINE_<part>_DEBIAN. part: CORE or
# SIMULATION.
function(plumbline_note_dependencies name part)
  get_target_property(type ${name} TYPE)
  if(type STREQUAL INTERFACE_LIBRARY)
    get_target_property(links ${name} INTERFACE_LINK_LIBRARIES)
  else()
    get_target_property(links ${name} LINK_LIBRARIES)
  endif()
  foreach(link IN LISTS links)
    if(NOT link OR link MATCHES "^plumbline_|plumbline_options>$")
      continue()
    endif()
    set(rows ${PLUMBLINE_DEPENDENCIES})
    list(FILTER rows INCLUDE REGEX "^${link}\\|")
    if(NOT rows)
      message(FATAL_ERROR
        "${name} links ${link}: scripts/packaging/cmake/dependencies.cmake needs a row for it, so that others can "
        "link ${name}")
    endif()
    string(REPLACE "|" ";" row "${rows}")
    list(GET row 1 command)
    list(GET row 2 package)
    set_property(GLOBAL APPEND PROPERTY PLUMBLINE_${part}_CMAKE ${command})
    set_property(GLOBAL APPEND PROPERTY PLUMBLINE_${part}_DEBIAN ${package})
  endforeach()
endfunction()

# Sets a variable to what was noted, each once, in the order of the alphabet, for SIMULATION without
# what CORE has already. kind: CMAKE or DEBIAN.
function(plumbline_get_dependencies variable part kind separator)
  get_property(items GLOBAL PROPERTY PLUMBLINE_${part}_${kind})
  if(part STREQUAL SIMULATION)
    get_property(of_core GLOBAL PROPERTY PLUMBLINE_CORE_${kind})
    list(REMOVE_ITEM items ${of_core})
  endif()
  list(REMOVE_DUPLICATES items)
  list(SORT items)
  list(JOIN items "${separator}" text)
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()
