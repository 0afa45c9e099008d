# Somebody else's project, tests/accept/find_package, built and run against an installed tree: that of accept.install, or
# with WHAT=onboard_only an onboard library that is built here, with GDAL and all other libraries of the ground out of
# reach. Input: SOURCE, BUILD, INSTALLED, WHAT, SANITIZE, GENERATOR, CXX, LAUNCHER, JOBS.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "$ ${command}\n${output}")
  endif()
endfunction()

set(work ${BUILD}/accept/find_package_${WHAT})
file(REMOVE_RECURSE ${work}/prefix ${work}/consumer ${work}/build/CMakeCache.txt)  # what an earlier run disabled stays in the cache
set(common -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})

if(WHAT STREQUAL "onboard_only")
  set(component onboard)
  set(prefix ${work}/prefix)
  foreach(package GDAL nlohmann_json Ceres CLI11 GTest)
    list(APPEND common -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  # What is looked for is missing sources, headers and libraries: nothing is optimised.
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build ${common} -DPILOTAGE_ONBOARD_ONLY=ON -DPILOTAGE_SANITIZE=${SANITIZE}
      -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0)
  run(${CMAKE_COMMAND} --build ${work}/build --parallel ${JOBS})
  run(${CMAKE_COMMAND} --install ${work}/build --prefix ${prefix})
else()
  set(component prep)
  set(prefix ${INSTALLED}/everything)
endif()

if(SANITIZE)
  list(APPEND common -DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/accept/find_package -B ${work}/consumer ${common}
    -DCMAKE_PREFIX_PATH=${prefix} -DCOMPONENT=${component})
run(${CMAKE_COMMAND} --build ${work}/consumer --parallel ${JOBS})
run(${work}/consumer/use_${component} ${SOURCE}/tests/fuzz/corpus/map/two_levels ${SOURCE}/README.md)
