# Configures the project `embed` with a Bullet of both precisions, compiles what is quick, and looks at the rest.
function(run result_wanted)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(result_wanted STREQUAL "ok" AND NOT result EQUAL 0 OR result_wanted STREQUAL "refused" AND result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${result}:\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

function(expect words)
  if(NOT text MATCHES "${words}")
    message(FATAL_ERROR "not there: ${words}\n${text}")
  endif()
endfunction()

function(expect_none words)
  if(text MATCHES "${words}")
    message(FATAL_ERROR "should not be there: ${words} (${CMAKE_MATCH_0})\n${text}")
  endif()
endfunction()

set(configure ${CMAKE_COMMAND} -S ${SOURCE} -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER})
file(REMOVE_RECURSE ${SCRATCH})

foreach(precision single double)
  set(build ${SCRATCH}/${precision})
  set(library oilskin_bullet)
  if(precision STREQUAL "double")
    set(library oilskin_bullet_f64)
  endif()
  run(ok ${configure} -B ${build} -DPRECISION=${precision})
  expect("Bullet of ${precision} precision from OILSKIN_BULLET_TARGETS")

  # Nothing in the parent's cache that it did not ask for, and nothing in its target `all`.
  file(READ ${build}/CMakeCache.txt text)
  expect("CMAKE_BUILD_TYPE:STRING=\n")
  expect_none("BUILD_TESTING")
  run(ok ${CMAKE_COMMAND} --build ${build} -- -n all)
  expect_none("liboilskin|oilskin/")

  # The game links its own Bullet after the adapter, and no other.
  run(ok ${CMAKE_COMMAND} --build ${build} -- -n -v game)
  expect("-o game [^\n]*lib${library}\\.a[^\n]*libOwnSoftBody\\.a[^\n]*libOwnDynamics\\.a")
  expect_none("LinearMath|lBullet")
endforeach()

# In the last of the two: the library keeps Eigen's alignment, a user may have another.
run(ok ${CMAKE_COMMAND} --build ${SCRATCH}/double --target aligned_16 aligned_32
    oilskin/bullet_adapter/CMakeFiles/oilskin_bullet_f64.dir/link_guard.cpp.o)

# Names that are no targets need a stated precision, which is taken as it is.
run(refused ${configure} -B ${SCRATCH}/named -DSTATED=SomeBullet)
expect("none of\n* *OILSKIN_BULLET_TARGETS.*OILSKIN_BULLET_PRECISION")
run(ok ${configure} -B ${SCRATCH}/named -DSTATED=SomeBullet -DPRECISION=double -DOILSKIN_BULLET_PRECISION=double)
run(ok ${CMAKE_COMMAND} --build ${SCRATCH}/named -- -n -v game)
expect("-o game [^\n]*liboilskin_bullet_f64\\.a[^\n]*-lSomeBullet")
