# Three fuzz targets. In every build each is a test that replays its seeds (fuzz_NAME_replay); with
# OILSKIN_FUZZERS (clang) also a libFuzzer program (docs/manual/testing.md).
function(oilskin_add_fuzz_target name mutations)
  oilskin_add_test(fuzz_${name}_replay SOURCES libfuzzer_${name}.cpp fuzz_target.cpp replay_test.cpp
                   LIBRARIES ${ARGN} LABELS fuzz)
  target_link_libraries(fuzz_${name}_replay PRIVATE GTest::gtest)
  target_compile_definitions(fuzz_${name}_replay PRIVATE OILSKIN_MUTATIONS=${mutations}
    OILSKIN_REGRESSIONS="${CMAKE_CURRENT_SOURCE_DIR}/regressions/${name}")
  set(targets fuzz_${name}_replay)
  if(OILSKIN_FUZZERS)
    add_executable(fuzz_${name} libfuzzer_${name}.cpp fuzz_target.cpp)
    target_link_libraries(fuzz_${name} PRIVATE oilskin::oilskin oilskin_flags ${ARGN})
    target_include_directories(fuzz_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/src)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
    list(APPEND targets fuzz_${name})
    add_dependencies(fuzzers ${targets})
  endif()
  foreach(target ${targets})
    target_compile_definitions(${target} PRIVATE OILSKIN_SCENES="${PROJECT_SOURCE_DIR}/demos/scenes"
      OILSKIN_FUZZ_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data")
  endforeach()
endfunction()

if(OILSKIN_FUZZERS)
  add_custom_target(fuzzers)
endif()
oilskin_add_fuzz_target(contact 200 oilskin_auditor)
oilskin_add_fuzz_target(restore 100)
foreach(name contact restore)
  target_compile_definitions(fuzz_${name}_replay PRIVATE OILSKIN_BINARY_INPUT)
endforeach()
if(TARGET oilskin_app)
  oilskin_add_fuzz_target(scene 20 oilskin_app)
endif()
