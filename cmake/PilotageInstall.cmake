# cmake --install: headers, libraries, the program, and the package that find_package(pilotage COMPONENTS onboard prep) finds.
# Components: "onboard" (what flies; needs neither GDAL nor anything else of the ground) and "prep" (the rest).
# Installed headers are the entry of a component and what it includes: pilotage/onboard.h, pilotage/prep.h.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pilotage)

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

pilotage_install_library(onboard)
pilotage_install_headers(onboard pilotage/onboard.h)
if(TARGET pilotage_prep)
  pilotage_install_library(prep)
  install(TARGETS pilotage RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT prep)
  pilotage_install_headers(prep pilotage/prep.h pilotage/onboard.h)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/man/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT prep)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/bash-completion ${PROJECT_BINARY_DIR}/share/zsh
          ${PROJECT_BINARY_DIR}/share/fish DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT prep)
  install(DIRECTORY schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/pilotage COMPONENT prep OPTIONAL)
endif()

configure_package_config_file(cmake/pilotageConfig.cmake.in ${PROJECT_BINARY_DIR}/pilotageConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pilotageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pilotageConfig.cmake ${PROJECT_BINARY_DIR}/pilotageConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT onboard)
