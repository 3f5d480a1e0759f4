# page_eigen: a copy of Eigen's headers that uses SSE2, which emcc expresses in the vector instructions of WebAssembly.
# Eigen adds three doubles as (a + b) + c where it has vectors of two and they lie one after the other, and as a + (b + c)
# elsewhere: without SSE2, or in rows of a matrix. With it every sum of this build is that of the desktop.
#   - Eigen has assembler text of x86 for a GCC before 6.3, which Clang passes for. The copy takes the intrinsics instead.
#   - Eigen includes mmintrin.h, which Clang has for x86 alone, and uses nothing of it: an empty file stands in its place.
find_path(OILSKIN_EIGEN_HEADERS Eigen/Core PATHS /usr/include/eigen3 /usr/local/include/eigen3 NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED)
set(page_eigen ${CMAKE_BINARY_DIR}/eigen)
if(NOT EXISTS ${page_eigen}/done)
  file(COPY ${OILSKIN_EIGEN_HEADERS}/Eigen DESTINATION ${page_eigen})
  set(packets ${page_eigen}/Eigen/src/Core/arch/SSE/PacketMath.h)
  file(READ ${packets} text)
  string(REPLACE "#if EIGEN_COMP_GNUC && EIGEN_COMP_GNUC < 63" "#if 0" changed "${text}")
  if(changed STREQUAL text)
    message(FATAL_ERROR "${packets} has no assembler text for old compilers where this file expects it")
  endif()
  file(WRITE ${packets} "${changed}")
  file(WRITE ${page_eigen}/mmintrin.h "")
  # The package that find_package(Eigen3) finds in this build.
  file(WRITE ${page_eigen}/Eigen3Config.cmake
       "if(NOT TARGET Eigen3::Eigen)\n  add_library(Eigen3::Eigen INTERFACE IMPORTED)\n"
       "  target_include_directories(Eigen3::Eigen SYSTEM INTERFACE ${page_eigen})\nendif()\n")
  file(WRITE ${page_eigen}/Eigen3ConfigVersion.cmake "set(PACKAGE_VERSION 3.4)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
  file(TOUCH ${page_eigen}/done)
endif()
set(Eigen3_DIR ${page_eigen} CACHE PATH "" FORCE)
add_compile_options(-msse2 "SHELL:-isystem ${page_eigen}")
