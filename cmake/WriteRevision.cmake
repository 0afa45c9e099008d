# cmake -DSOURCE=. -DOUTPUT=build/dev/include/pilotage_revision.h -P cmake/WriteRevision.cmake
# The commit that the sources are of, for `pilotage --version`: what git says, or in an archive of a commit what git archive put into
# cmake/revision.txt. The file is written anew only where it says something else, so that nothing is compiled again for nothing.
cmake_minimum_required(VERSION 3.25)

file(STRINGS ${SOURCE}/cmake/revision.txt archived LIMIT_COUNT 1)
set(revision "unknown")
if(archived MATCHES "^([0-9a-f]+) ([0-9-]+)$")
  string(SUBSTRING ${CMAKE_MATCH_1} 0 12 revision)
  string(APPEND revision " of ${CMAKE_MATCH_2}")
else()
  set(git git -C ${SOURCE})
  execute_process(COMMAND ${git} log -1 --abbrev=12 "--format=%h of %cs" RESULT_VARIABLE result OUTPUT_VARIABLE commit
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(result EQUAL 0)
    set(revision ${commit})
    execute_process(COMMAND ${git} status --porcelain OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      string(APPEND revision ", with changes")
    endif()
  endif()
endif()

set(text "#pragma once\n\n#define PILOTAGE_REVISION \"${revision}\"\n")
set(written "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} written)
endif()
if(NOT written STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
