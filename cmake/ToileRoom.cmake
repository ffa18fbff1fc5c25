# toile_add_room(NAME SOURCES a.cpp ... LINK targets...) makes the library toile_NAME with the alias toile::NAME.
function(toile_compile_options target)
  # g++ 12 warns of overlaps in std::string's operator+ that are not there (its bug 105651).
  # -Wno-psabi: functions that take SIMD lanes (cloth/lane.h) are always inlined, so they have no calling convention.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> -Wno-psabi)
  if(TOILE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
  if(TOILE_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

function(toile_add_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  add_library(toile_${name} STATIC ${ROOM_SOURCES})
  add_library(toile::${name} ALIAS toile_${name})
  target_include_directories(toile_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(toile_${name} PUBLIC ${ROOM_LINK} PRIVATE ${ROOM_LINK_PRIVATE})
  toile_compile_options(toile_${name})
endfunction()

# toile_add_test(NAME SOURCES ... LINK ...): one GoogleTest program a room, tests/NAME/test_*.cpp.
function(toile_add_test name)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINK" ${ARGN})
  add_executable(test_${name} ${TEST_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(test_${name} PRIVATE ${TEST_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE TOILE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             TOILE_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  toile_compile_options(test_${name})
  gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600 LABELS ${name})
endfunction()
