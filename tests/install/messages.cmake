# Installs, and configures the project `messages`. Its list ADAPTERS comes with commas.
function(run)
  execute_process(COMMAND ${CMAKE_COMMAND} ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "cmake ${ARGV}\n${text}")
  endif()
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(--install ${BUILD} --prefix ${SCRATCH}/prefix --component development)
run(-S ${SOURCE} -B ${SCRATCH}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
    -DADAPTERS=${ADAPTERS})
