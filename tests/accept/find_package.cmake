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
  foreach(package GDAL nlohmann_json PkgConfig Ceres)
    list(APPEND common -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  # Headers of the ground's libraries that some source includes: here they only say that they must not be.
  file(REMOVE_RECURSE ${work}/of_the_ground)
  file(GLOB_RECURSE sources ${SOURCE}/src/*.h ${SOURCE}/src/*.cc)
  foreach(source IN LISTS sources)
    file(STRINGS ${source} includes REGEX "^[ \t]*#[ \t]*include[ \t]*<")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE ".*<(.*)>.*" "\\1" header "${include}")
      if(header MATCHES "^(gdal|ogr|cpl_|nlohmann/|GeographicLib/|fftw|sodium|yaml-cpp/|dlib/|opencv2/imgcodecs|ceres/)" AND
         NOT header MATCHES "^ceres/tiny_solver")
        file(WRITE ${work}/of_the_ground/${header} "#error \"<${header}> belongs to the ground, not to what flies\"\n")
      endif()
    endforeach()
  endforeach()
  if(NOT EXISTS ${work}/of_the_ground/nlohmann/json.hpp)
    message(FATAL_ERROR "no header of the ground's libraries was found in ${SOURCE}/src")
  endif()
  set(flags -I${work}/of_the_ground)

  # The one library of which only headers are used is named when it is missing.
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/without_ceres ${common} -DPILOTAGE_ONBOARD_ONLY=ON
                          -DPILOTAGE_CERES_INCLUDE_DIR=${work}/nowhere
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result EQUAL 0 OR NOT output MATCHES "libceres-dev")
    message(FATAL_ERROR "without Ceres' headers the configuration does not say what is missing:\n${output}")
  endif()
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build ${common} -DPILOTAGE_ONBOARD_ONLY=ON -DPILOTAGE_SANITIZE=${SANITIZE}
      -DCMAKE_CXX_FLAGS=${flags})
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
  string(APPEND flags " -fsanitize=${SANITIZE}")
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/accept/find_package -B ${work}/consumer ${common}
    -DCMAKE_PREFIX_PATH=${prefix} -DCOMPONENT=${component} "-DCMAKE_CXX_FLAGS=${flags}")
run(${CMAKE_COMMAND} --build ${work}/consumer)
run(${work}/consumer/use_${component})
