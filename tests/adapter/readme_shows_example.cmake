# The README shows the example that is compiled and run as a test, line by line.
# use: cmake -DREADME=… -DEXAMPLE=… -P readme_shows_example.cmake
file(READ ${README} readme)
file(READ ${EXAMPLE} example)
string(REGEX REPLACE "^.*// \\[example\\]\n(.*)  // \\[example\\].*$" "\\1" shown "${example}")
string(STRIP "${shown}" shown)
string(LENGTH "${shown}" length)
if(length LESS 500)
  message(FATAL_ERROR "the example has lost its marks")
endif()
string(FIND "${readme}" "${shown}" at)
if(at EQUAL -1)
  message(FATAL_ERROR "README.md does not show ${EXAMPLE} as it is between its marks")
endif()
