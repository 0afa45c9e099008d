# The lists of exported functions in debian/ are those of the libraries: a package is not made with one that is gone, and
# one that is not listed asks for no version. Input: LIBRARY (a shared library), LIST (its file in debian/).
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
execute_process(COMMAND nm -D --defined-only ${LIBRARY} COMMAND c++filt OUTPUT_VARIABLE exported RESULT_VARIABLE result
                ERROR_VARIABLE error)
if(NOT result EQUAL 0 OR exported STREQUAL "")
  problem("nm ${LIBRARY}: ${error}")
endif()
file(READ ${SOURCE}/debian/${LIST} listed)

file(STRINGS ${SOURCE}/debian/${LIST} lines REGEX "^ \\(c\\+\\+\\)\"pilotage::")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^ \\(c\\+\\+\\)\"(.*)@Base\".*" "\\1" name "${line}")
  string(FIND "${exported}" " ${name}\n" place)
  if(place EQUAL -1)
    problem("debian/${LIST}: the library has no ${name}")
  endif()
endforeach()

# Constants, templates and what compilers make of functions stand there as patterns.
string(REGEX MATCHALL "[0-9a-f]+ [TW] pilotage::[^\n]*" functions "${exported}")
foreach(function IN LISTS functions)
  string(REGEX REPLACE "^[0-9a-f]+ [TW] " "" name "${function}")
  if(name MATCHES "^pilotage::k[A-Z]|^pilotage::[^(]* pilotage::|{lambda|\\[clone")
    continue()
  endif()
  string(FIND "${listed}" " (c++)\"${name}@Base\"" place)
  if(place EQUAL -1)
    problem("debian/${LIST} does not list ${name}")
  endif()
endforeach()
finish("debian/${LIST} lists what the library exports")
