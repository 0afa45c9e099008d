# Nothing in the repository knows the machine it was written on.
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
# Brackets keep the pattern from finding itself.
execute_process(
  COMMAND grep -rnIE --exclude-dir=build --exclude-dir=install --exclude-dir=.git --exclude=.git --exclude-dir=.cache
          "(^|[^a-zA-Z0-9_.~-])/(wor[k]|hom[e]/[a-z]|roo[t])/" .
  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE result)
if(result EQUAL 0)
  problem("${found}")
elseif(NOT result EQUAL 1)
  problem("grep failed: ${result}")
endif()
finish("no paths of one machine in the repository")
