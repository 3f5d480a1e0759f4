# Installs into a prefix, moves it, and builds programs with the compiler and pkg-config alone, from the folder EXAMPLES
# and the file GUARDED.
# MODULES: those of oilskin-bullet, oilskin-bullet-f64 that the build has, with commas between.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nfailed with ${result}:\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/first --component development)
file(RENAME ${SCRATCH}/first ${SCRATCH}/moved)
file(GLOB_RECURSE files ${SCRATCH}/moved/*.pc)
list(GET files 0 file)
get_filename_component(folder ${file} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${folder}:$ENV{PKG_CONFIG_PATH})

# Optimised: inline functions of the headers may be taken from the program.
set(flags -std=c++17 -O2)
if(SANITIZE)
  list(APPEND flags -fsanitize=${SANITIZE})
endif()

# build(module source program): compiles, links and runs.
function(build module source program)
  run(${PKG_CONFIG} --cflags --libs ${module})
  separate_arguments(words UNIX_COMMAND "${text}")
  if(NOT text MATCHES "${SCRATCH}/moved")
    message(FATAL_ERROR "${module} does not follow the move: ${text}")
  endif()
  run(${COMPILER} ${flags} ${source} -o ${SCRATCH}/${program} ${words})
  run(${SCRATCH}/${program})
  set(output "${text}" PARENT_SCOPE)
endfunction()

string(REPLACE "," ";" MODULES "${MODULES}")
list(POP_FRONT MODULES first)
if(first)
  build(${first} ${EXAMPLES}/hello_bullet.cpp hello_bullet)
  include(${CMAKE_CURRENT_LIST_DIR}/hello_bullet.cmake)
else()
  build(oilskin ${EXAMPLES}/contact_alone.cpp contact_alone)
  if(NOT output MATCHES "crossings: 0\n")
    message(FATAL_ERROR "contact_alone printed:\n${output}")
  endif()
endif()
# Links only with the adapter of the precision that its module's flags make it see.
foreach(module ${MODULES})
  build(${module} ${GUARDED} ${module})
endforeach()
