# The Hamming search of 64-bit ARM (vision/hamming_neon.cc): cross-built with its tests, and these run by an emulator. The whole
# onboard library is built and flown so by tools/try-arm64. Input: SOURCE, BUILD, GENERATOR, LAUNCHER.
cmake_minimum_required(VERSION 3.25)
find_program(compiler aarch64-linux-gnu-g++)
find_program(emulator NAMES qemu-aarch64 qemu-aarch64-static)
if(NOT compiler OR NOT emulator OR NOT EXISTS /usr/src/googletest/googletest)
  message("skipped: no cross compiler, emulator or sources of GoogleTest: apt-get install g++-aarch64-linux-gnu qemu-user libgtest-dev")
  return()
endif()
set(work ${BUILD}/accept/arm64)
foreach(command
    "${CMAKE_COMMAND};-G;${GENERATOR};-S;${SOURCE}/tests/arm64;-B;${work};-DCMAKE_BUILD_TYPE=Release;-DCMAKE_SYSTEM_NAME=Linux;-DCMAKE_SYSTEM_PROCESSOR=aarch64;-DCMAKE_CXX_COMPILER=${compiler};-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}"
    "${CMAKE_COMMAND};--build;${work}"
    "${emulator};${work}/test_hamming")
  execute_process(COMMAND ${command} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "$ ${command}\n${output}")
  endif()
endforeach()
# A path that this processor cannot run skips its tests: this one may not.
if(NOT output MATCHES "\\[       OK \\] All/HammingPaths[^\n]*/neon" OR output MATCHES "SKIPPED[^\n]*/neon")
  message(FATAL_ERROR "the tests of the path neon did not run:\n${output}")
endif()
string(REGEX MATCH "PASSED[^\n]*" passed "${output}")
message("${passed}")
