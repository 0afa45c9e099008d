# cmake --install: headers, libraries, the program, and the package that find_package(pilotage COMPONENTS onboard prep) finds.
# Components: "onboard" (what flies; needs neither GDAL nor anything else of the ground) and "prep" (the rest).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pilotage)

install(TARGETS pilotage_onboard EXPORT pilotage-onboard-targets COMPONENT onboard)
install(EXPORT pilotage-onboard-targets NAMESPACE pilotage:: DESTINATION ${package_dir} COMPONENT onboard)
foreach(folder base geo raster camera vision mapdb match)
  install(DIRECTORY src/pilotage/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pilotage COMPONENT onboard
          FILES_MATCHING PATTERN "*.h" PATTERN "gdal_*.h" EXCLUDE)
endforeach()

if(TARGET pilotage_prep)
  install(TARGETS pilotage_prep EXPORT pilotage-prep-targets COMPONENT prep)
  install(EXPORT pilotage-prep-targets NAMESPACE pilotage:: DESTINATION ${package_dir} COMPONENT prep)
  install(TARGETS pilotage RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT prep)
  install(DIRECTORY src/pilotage DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT prep
          FILES_MATCHING PATTERN "*.h" PATTERN compare EXCLUDE)
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
