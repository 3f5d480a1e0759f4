# Writes HEADER with the commit of SOURCE, when it has changed. Variables: SOURCE, GIT, HEADER.
set(commit "unknown")
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --abbrev=10
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE code ERROR_QUIET)
  if(code EQUAL 0)
    set(commit ${found})
  endif()
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT [[
#pragma once
namespace oilskin::demo {
constexpr const char* commit = "@commit@";
}  // namespace oilskin::demo
]] @ONLY)
