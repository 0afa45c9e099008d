# How our own targets are compiled: warnings are errors, sanitizers and assertions by option.

# Floating-point contraction is off so that the same source gives the same numbers whether or not the compiler may use FMA.
add_library(pilotage_compile_options INTERFACE)
target_compile_options(pilotage_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # "literal" + std::string at -O3 is taken for overlapping memory: https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105651
  target_compile_options(pilotage_compile_options INTERFACE -Wno-restrict)
endif()
# CMAKE_CXX_FLAGS_RELEASE brings -DNDEBUG; the presets that want assertions take it back.
if(PILOTAGE_ASSERTIONS)
  target_compile_options(pilotage_compile_options INTERFACE -UNDEBUG)
  target_compile_definitions(pilotage_compile_options INTERFACE _GLIBCXX_ASSERTIONS)
endif()
if(PILOTAGE_SANITIZE)
  add_compile_options(-fsanitize=${PILOTAGE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PILOTAGE_SANITIZE})
endif()
if(PILOTAGE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "PILOTAGE_FUZZ needs clang; use the preset fuzz")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# pilotage_add_tests(<folder> <file>_test.cc ...): one GoogleTest program per source folder, its cases known to ctest one by one.
function(pilotage_add_tests folder)
  add_executable(test_${folder} ${ARGN})
  target_link_libraries(test_${folder} PRIVATE pilotage_testing pilotage_compile_options GTest::gmock_main)
  target_include_directories(test_${folder} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  gtest_discover_tests(test_${folder} TEST_PREFIX "${folder}." DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "unit")
endfunction()
