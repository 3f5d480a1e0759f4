if(NOT output MATCHES "([0-9]+) particles, ([0-9]+) contacts" OR CMAKE_MATCH_1 LESS 100 OR CMAKE_MATCH_2 LESS 1)
  message(FATAL_ERROR "hello_bullet printed:\n${output}")
endif()
