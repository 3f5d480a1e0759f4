# fcl: those sources of FCL that src/proximity/surface_tree.cpp needs, and a package file that lets find_package(fcl)
# accept them. The rest of FCL, which needs libccd and takes minutes to build, is left out.
file(GLOB fcl_root ${OILSKIN_PAGE_SOURCES}/fcl-*)
list(FILTER fcl_root EXCLUDE REGEX "\\.(xz|gz|dsc)$|_")
list(LENGTH fcl_root found)
if(NOT found EQUAL 1)
  message(FATAL_ERROR "OILSKIN_PAGE_SOURCES (${OILSKIN_PAGE_SOURCES}) must hold one folder fcl-*, not ${found}")
endif()
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" FCL_VERSION "${fcl_root}")
string(REPLACE "." ";" parts "${FCL_VERSION}")
list(GET parts 0 FCL_MAJOR_VERSION)
list(GET parts 1 FCL_MINOR_VERSION)
list(GET parts 2 FCL_PATCH_VERSION)
set(FCL_HAVE_SSE OFF)
set(FCL_HAVE_OCTOMAP OFF)
set(FCL_ENABLE_PROFILING OFF)
configure_file(${fcl_root}/include/fcl/config.h.in ${CMAKE_BINARY_DIR}/fcl/include/fcl/config.h)
file(WRITE ${CMAKE_BINARY_DIR}/fcl/include/fcl/export.h "#pragma once\n#define FCL_EXPORT\n#define FCL_DEPRECATED\n#define FCL_DEPRECATED_EXPORT\n")

file(GLOB fcl_sources ${fcl_root}/src/geometry/bvh/*.cpp ${fcl_root}/src/geometry/bvh/detail/*.cpp
     ${fcl_root}/src/math/bv/*.cpp)
add_library(fcl STATIC ${fcl_sources} ${fcl_root}/src/geometry/collision_geometry.cpp ${fcl_root}/src/math/geometry.cpp
            ${fcl_root}/src/math/constants.cpp ${fcl_root}/src/math/triangle.cpp)
target_include_directories(fcl SYSTEM PUBLIC ${CMAKE_BINARY_DIR}/fcl/include ${fcl_root}/include ${page_eigen})
target_compile_options(fcl PRIVATE -ffp-contract=off -w PUBLIC -DEIGEN_MAX_ALIGN_BYTES=16)

file(WRITE ${CMAKE_BINARY_DIR}/fcl/fcl-config.cmake "# The target fcl is part of this build.\n")
file(WRITE ${CMAKE_BINARY_DIR}/fcl/fcl-config-version.cmake
     "set(PACKAGE_VERSION ${FCL_VERSION})\nif(NOT PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)\n  set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n")
set(fcl_DIR ${CMAKE_BINARY_DIR}/fcl CACHE PATH "" FORCE)
