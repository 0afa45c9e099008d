# What a library user includes, pilotage/onboard.h and pilotage/prep.h, and every header that these include: the headers
# that are installed. Input: BUILD, where version.h is; ONBOARD_SOURCES, the sources of pilotage::onboard
# with | between them.
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
include(${SOURCE}/cmake/HeadersOf.cmake)
set(HEADER_FOLDERS ${SOURCE}/src ${BUILD}/include)
string(REPLACE "|" ";" ONBOARD_SOURCES "${ONBOARD_SOURCES}")

# The libraries whose headers an installed one may include: those that its component finds for its user.
set(foreign_onboard "^(Eigen|opencv2)/")
set(foreign_prep "^(Eigen|opencv2|nlohmann)/")
set(public "")
foreach(component onboard prep)
  file(STRINGS ${SOURCE}/src/pilotage/${component}.h lines)
  list(LENGTH lines count)
  if(count GREATER 100)
    problem("src/pilotage/${component}.h: ${count} lines; an entry header is a guide of at most 100")
  endif()
  pilotage_headers_of(headers_${component} pilotage/${component}.h)
  list(APPEND public ${headers_${component}})
  foreach(header IN LISTS headers_${component})
    pilotage_find_header(path ${header})
    file(STRINGS ${path} includes REGEX "^[ \t]*#[ \t]*include[ \t]*<[^>]*[/.]")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE ".*<([^>]+)>.*" "\\1" included "${include}")
      if(NOT included MATCHES "${foreign_${component}}")
        problem("${header}: is installed with ${component}, whose users need not have <${included}>")
      endif()
    endforeach()
  endforeach()
endforeach()

# A header of what flies is declared there and defined there.
foreach(header IN LISTS headers_onboard)
  string(REGEX REPLACE "\\.h$" ".cc" source ${header})
  if(EXISTS ${SOURCE}/src/${source} AND NOT "${SOURCE}/src/${source}" IN_LIST ONBOARD_SOURCES)
    problem("${header}: is installed with onboard; ${source} is not part of pilotage::onboard")
  endif()
endforeach()

# An entry header is for users; the library's own files include what they need.
our_files(files *.h *.cc)
foreach(file IN LISTS files)
  file(STRINGS ${SOURCE}/${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]+\"pilotage/(onboard|prep)\\.h\"")
  if(includes AND file MATCHES "^(src|tools)/")
    problem("${file}: ${includes}: include the header that declares what is used")
  endif()
endforeach()
finish("installed headers are the entry headers and what these include, need what their component finds, and are defined in it")
