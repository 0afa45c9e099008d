# The shared libraries, made of the objects of the static ones: libpilotage_onboard.so and libpilotage_prep.so.
#
# What they export is what the installed headers declare; everything else is hidden. The ground's half calls functions of
# the onboard half that are hidden, so libpilotage_prep.so holds both and a program needs one of the two.

# pilotage_add_shared(<name> <part>...): the target pilotage_<name>_shared of the objects of pilotage_<part>…
function(pilotage_add_shared name)
  set(target pilotage_${name}_shared)
  add_library(${target} SHARED)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME pilotage_${name} EXPORT_NAME ${name} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
  foreach(part IN LISTS ARGN)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:pilotage_${part}>)
    target_link_libraries(${target} PRIVATE pilotage_${part}) # for what it needs: its own objects are there already
  endforeach()
  if(NOT PILOTAGE_SANITIZE)
    target_link_options(${target} PRIVATE LINKER:-z,defs) # a symbol that is nowhere is found here and not by the user
  endif()
  target_link_options(${target} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exported_names.map)
  set_target_properties(${target} PROPERTIES LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exported_names.map)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} INTERFACE Eigen3::Eigen opencv_core) # in the headers
endfunction()

pilotage_add_shared(onboard onboard)
if(TARGET pilotage_prep)
  pilotage_add_shared(prep prep onboard)
  target_link_libraries(pilotage_prep_shared INTERFACE nlohmann_json::nlohmann_json)
endif()
