# The library returns what it has to say; printing is for tools/.
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
execute_process(
  COMMAND grep -rnE --include=*.h --include=*.cc
          "<iostream>|std::(cout|cerr|clog)|(^|[^a-z_])(std::)?(printf|fprintf|puts|fputs|perror)[ ]*\\(" src
  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE result)
if(result EQUAL 0)
  problem("${found}")
elseif(NOT result EQUAL 1)
  problem("grep failed: ${result}")
endif()
finish("no printing in src/")
