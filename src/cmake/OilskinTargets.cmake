# Flags that every target of the project carries. They belong to targets, not to the directory, so that a
# project that embeds Oilskin with add_subdirectory keeps its own.

# Same input, same bits: no contraction into fused multiply-adds (it would differ between compilers and
# instruction sets), no reassociation. The error bounds of the continuous test need strict IEEE arithmetic too.
add_library(oilskin_flags INTERFACE)
target_compile_options(oilskin_flags INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-ffp-contract=off -fno-fast-math -Wall -Wextra -Wshadow -Wno-psabi>)
if(OILSKIN_ASSERTS)
  target_compile_definitions(oilskin_flags INTERFACE OILSKIN_ASSERTS)
endif()
if(OILSKIN_SANITIZE)
  target_compile_options(oilskin_flags INTERFACE -fsanitize=${OILSKIN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(oilskin_flags INTERFACE -fsanitize=${OILSKIN_SANITIZE})
endif()
if(OILSKIN_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "Oilskin: OILSKIN_FUZZERS needs Clang; use the preset `fuzz`, or -DCMAKE_CXX_COMPILER=clang++")
  endif()
  target_compile_options(oilskin_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# The alignment trap. Debian's libfcl is compiled without -march flags, so Eigen aligned its fixed-size types to
# 16 bytes there. A program compiled with -mavx2 or -march=native would align them to 32 or 64, disagree with
# libfcl on the layout of every FCL object that holds a transform, and crash. Fixing Eigen's largest alignment at
# 16 on everything that includes Eigen through Oilskin makes both sides agree, whatever flags a user chooses.
# (libccd and octomap do not matter: FCL is used for its bounding-volume trees only.)
# The library always has 16. A user who defines EIGEN_MAX_ALIGN_BYTES keeps his value: public headers have only
# Vector3d and Matrix3d, which Eigen never aligns. The value comes as an option, because an option may look at the user's
# definitions; a definition may not.
set(OILSKIN_EIGEN_ALIGNMENT 16)
target_compile_options(oilskin_flags INTERFACE
  "SHELL:-UEIGEN_MAX_ALIGN_BYTES -DEIGEN_MAX_ALIGN_BYTES=${OILSKIN_EIGEN_ALIGNMENT}")
string(CONCAT OILSKIN_EIGEN_OPTION
  "$<$<STREQUAL:$<FILTER:$<TARGET_PROPERTY:COMPILE_DEFINITIONS>,INCLUDE,^(-D)?EIGEN_MAX_ALIGN_BYTES>,>:"
  "-DEIGEN_MAX_ALIGN_BYTES=${OILSKIN_EIGEN_ALIGNMENT}>")
