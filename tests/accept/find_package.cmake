# Installs (the build tree, or with WHAT=onboard_only an onboard library built for the purpose) into a fresh folder, then
# configures, builds and runs tests/accept/find_package against it.
# Input: SOURCE, BUILD, WHAT, SANITIZE, GENERATOR, CXX, LAUNCHER.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "$ ${command}\n${output}")
  endif()
endfunction()

set(work ${BUILD}/accept/find_package_${WHAT})
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${prefix} ${work}/consumer)
set(common -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})

if(WHAT STREQUAL "onboard_only")
  set(component onboard)
  foreach(package GDAL nlohmann_json PkgConfig)
    list(APPEND common -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build ${common} -DPILOTAGE_ONBOARD_ONLY=ON -DPILOTAGE_SANITIZE=${SANITIZE})
  run(${CMAKE_COMMAND} --build ${work}/build)
  run(${CMAKE_COMMAND} --install ${work}/build --prefix ${prefix})
else()
  set(component prep)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
  run(${prefix}/bin/pilotage --version)
  foreach(file man/man1/pilotage.1 man/man1/pilotage-score.1 bash-completion/completions/pilotage
          zsh/site-functions/_pilotage fish/vendor_completions.d/pilotage.fish)
    if(NOT EXISTS ${prefix}/share/${file})
      message(FATAL_ERROR "share/${file} is not installed")
    endif()
  endforeach()
  file(GLOB_RECURSE strangers ${prefix}/*compare/*.h ${prefix}/*country/*.h ${prefix}/*pilotage_compare* ${prefix}/*sample_country*)
  if(strangers)
    message(FATAL_ERROR "installed, but no part of the libraries: ${strangers}")
  endif()
endif()

if(SANITIZE)
  list(APPEND common -DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/accept/find_package -B ${work}/consumer ${common}
    -DCMAKE_PREFIX_PATH=${prefix} -DCOMPONENT=${component})
run(${CMAKE_COMMAND} --build ${work}/consumer)
run(${work}/consumer/use_${component})
