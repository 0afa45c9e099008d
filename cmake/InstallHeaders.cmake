# Part of `cmake --install`: the headers of ENTRY, without those of INSTALLED_WITH, go below DESTINATION. They are found
# when they are installed, so the list is never older than the headers.
# Input: ENTRY, INSTALLED_WITH ("" or another entry), HEADER_FOLDERS, DESTINATION.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/HeadersOf.cmake)

pilotage_headers_of(headers ${ENTRY})
if(INSTALLED_WITH)
  pilotage_headers_of(others ${INSTALLED_WITH})
  list(REMOVE_ITEM headers ${others})
endif()
foreach(header IN LISTS headers)
  pilotage_find_header(path ${header})
  cmake_path(GET header PARENT_PATH folder)
  file(INSTALL ${path} DESTINATION ${DESTINATION}/${folder})
endforeach()
