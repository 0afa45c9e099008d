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

install(TARGETS pilotage_onboard EXPORT pilotage-onboard-targets COMPONENT onboard)
install(EXPORT pilotage-onboard-targets NAMESPACE pilotage:: DESTINATION ${package_dir} COMPONENT onboard)
pilotage_install_headers(onboard pilotage/onboard.h)

if(TARGET pilotage_prep)
  install(TARGETS pilotage_prep EXPORT pilotage-prep-targets COMPONENT prep)
  install(EXPORT pilotage-prep-targets NAMESPACE pilotage:: DESTINATION ${package_dir} COMPONENT prep)
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
