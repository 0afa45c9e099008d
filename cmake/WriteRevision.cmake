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
  # A copy of the sources inside of another repository is not of that one's commit: the prefix is empty at the top of one's own.
  set(git git --no-optional-locks -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse --show-prefix RESULT_VARIABLE result OUTPUT_VARIABLE prefix OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} log -1 --no-show-signature --abbrev=12 "--format=%h of %cs" RESULT_VARIABLE unknown OUTPUT_VARIABLE commit
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} status --porcelain --untracked-files=no RESULT_VARIABLE untold OUTPUT_VARIABLE changes ERROR_QUIET)
  if(result EQUAL 0 AND prefix STREQUAL "" AND unknown EQUAL 0 AND untold EQUAL 0)
    set(revision ${commit})
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
