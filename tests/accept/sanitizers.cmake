# Builds the tests of the target sanitized_tests by the preset sanitized (build/sanitized), and runs them: JOBS at a time, in the
# source folder.

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "exit code ${result}: ${ARGN}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --preset sanitized -DBUILD_TESTING=ON)
run(${CMAKE_COMMAND} --build --preset sanitized --target sanitized_tests -- -j ${JOBS})
run(${CMAKE_CTEST_COMMAND} --preset sanitized -L sanitized -j ${JOBS} --no-tests=error)
