# cmake --install: headers, libraries, the program, and the package that find_package(pilotage COMPONENTS onboard prep) finds.
# Components: "onboard" (what flies; needs neither GDAL nor anything else of the ground) and "prep" (the rest).
# Installed headers are the entry of a component and what it includes: pilotage/onboard.h, pilotage/prep.h.
# pkg-config finds them as pilotage-onboard and pilotage-prep.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pilotage)

# Before anything is written: one who may not write there is told where to.
install(CODE "
  set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  cmake_path(ABSOLUTE_PATH folder NORMALIZE)
  while(NOT EXISTS \"\${folder}\")
    cmake_path(GET folder PARENT_PATH folder)
  endwhile()
  execute_process(COMMAND test -w \"\${folder}\" RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR \"You may not write to \${folder}. Install below your home: cmake --install \${CMAKE_CURRENT_LIST_DIR} --prefix ~/.local \"
                        \"(its bin belongs on the PATH), or to \${CMAKE_INSTALL_PREFIX} as root.\")
  endif()" ALL_COMPONENTS)

# pilotage_install_headers(<component> <entry> [<entry installed before it>])
function(pilotage_install_headers component entry)
  install(CODE "
    set(ENTRY ${entry})
    set(INSTALLED_WITH ${ARGN})
    set(HEADER_FOLDERS [[${PROJECT_SOURCE_DIR}/src]] [[${PROJECT_BINARY_DIR}/include]])
    set(DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")
    include([[${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake]])" COMPONENT ${component})
endfunction()

# pilotage_install_library(<component>): the static library and, where it is made, the shared one, each for pilotageConfig.cmake.
function(pilotage_install_library component)
  install(TARGETS pilotage_${component} EXPORT pilotage-${component}-static-targets COMPONENT ${component})
  install(EXPORT pilotage-${component}-static-targets NAMESPACE pilotage:: DESTINATION ${package_dir} COMPONENT ${component})
  if(PILOTAGE_SHARED_LIBS)
    install(TARGETS pilotage_${component}_shared EXPORT pilotage-${component}-shared-targets COMPONENT ${component})
    install(EXPORT pilotage-${component}-shared-targets NAMESPACE pilotage:: DESTINATION ${package_dir}
            COMPONENT ${component})
  endif()
endfunction()

# pilotage_install_pkg_config(<component> <description> HEADERS <package>... LIBS <library>... STATIC_REQUIRES <package>... STATIC_LIBS <library>...)
# The packages whose headers ours include, the libraries that a program names, and what it links besides where it takes our static library:
# with `pkg-config --static`, or always where there is no other. The folder is told from the file's own, so that any prefix will do.
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE PC_PREFIX)
string(REGEX REPLACE "[^/]+" ".." PC_PREFIX "${PC_PREFIX}/pkgconfig")
foreach(folder INCLUDEDIR LIBDIR)
  if(IS_ABSOLUTE ${CMAKE_INSTALL_${folder}})
    set(PC_${folder} ${CMAKE_INSTALL_${folder}})
  else()
    set(PC_${folder} \${prefix}/${CMAKE_INSTALL_${folder}})
  endif()
endforeach()
function(pilotage_install_pkg_config component PC_DESCRIPTION)
  cmake_parse_arguments(PARSE_ARGV 2 pc "" "" "HEADERS;LIBS;STATIC_REQUIRES;STATIC_LIBS")
  list(APPEND pc_HEADERS ${pc_STATIC_REQUIRES})
  list(JOIN pc_HEADERS ", " PC_REQUIRES)
  list(TRANSFORM pc_LIBS PREPEND -l)
  list(TRANSFORM pc_STATIC_LIBS PREPEND -l)
  list(JOIN pc_LIBS " " PC_LIBS)
  list(JOIN pc_STATIC_LIBS " " PC_STATIC_LIBS)
  set(PC_KIND "")
  set(PC_PRIVATE_LIBS "")
  if(PILOTAGE_SHARED_LIBS)
    set(PC_KIND ".private")
    set(PC_PRIVATE_LIBS ${PC_STATIC_LIBS})
    set(PC_STATIC_LIBS "")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/pilotage.pc.in ${PROJECT_BINARY_DIR}/pilotage-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/pilotage-${component}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${component})
endfunction()

pilotage_install_library(onboard)
set(onboard_requires sqlite3 libzstd libsodium)
set(onboard_libs opencv_calib3d opencv_features2d opencv_imgproc)
pilotage_install_pkg_config(onboard "Finds an aircraft's position in a reference map, on board" HEADERS eigen3 opencv4
                            LIBS pilotage_onboard opencv_core STATIC_REQUIRES ${onboard_requires} STATIC_LIBS ${onboard_libs})
pilotage_install_headers(onboard pilotage/onboard.h)
if(TARGET pilotage_prep)
  pilotage_install_library(prep)
  pilotage_install_pkg_config(prep "Prepares and checks reference maps for aircraft, on the ground" HEADERS eigen3 opencv4 nlohmann_json
                              LIBS pilotage_prep opencv_core
                              STATIC_REQUIRES ${onboard_requires} gdal geographiclib proj fftw3f yaml-cpp
                              STATIC_LIBS pilotage_onboard opencv_imgcodecs ${onboard_libs} ceres glog)
  install(TARGETS pilotage RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT prep)
  pilotage_install_headers(prep pilotage/prep.h pilotage/onboard.h)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/man/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT prep)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/bash-completion ${PROJECT_BINARY_DIR}/share/zsh
          ${PROJECT_BINARY_DIR}/share/fish DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT prep)
  install(DIRECTORY schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/pilotage COMPONENT prep OPTIONAL)
  if(TARGET pilotage_python)
    install(FILES ${PILOTAGE_PYTHON_FILES} DESTINATION ${PILOTAGE_PYTHON_INSTALL_DIR}/pilotage COMPONENT prep)
    install(TARGETS pilotage_python_onboard DESTINATION ${PILOTAGE_PYTHON_INSTALL_DIR}/pilotage COMPONENT prep)
  endif()
  # The sample mission as a user has it: without the sources that it is computed from.
  install(DIRECTORY maps/sample DESTINATION ${CMAKE_INSTALL_DATADIR}/pilotage COMPONENT prep
          PATTERN "*.cc" EXCLUDE PATTERN country EXCLUDE PATTERN ".*" EXCLUDE)
endif()

configure_package_config_file(cmake/pilotageConfig.cmake.in ${PROJECT_BINARY_DIR}/pilotageConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pilotageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pilotageConfig.cmake ${PROJECT_BINARY_DIR}/pilotageConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT onboard)
