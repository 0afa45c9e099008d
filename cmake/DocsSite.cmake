# cmake -DSOURCE=. -DBUILD=build/dev -P cmake/DocsSite.cmake
# All pages of the project as one site in BUILD/site, by Sphinx: searchable, and nothing of it is fetched from anywhere. The pages of the
# libraries' interface (cmake/ApiDocs.cmake) are put into it, where they are made. A warning, as of a link that leads nowhere, is an error.
cmake_minimum_required(VERSION 3.25)
get_filename_component(SOURCE "${SOURCE}" ABSOLUTE)
get_filename_component(BUILD "${BUILD}" ABSOLUTE)
find_program(sphinx sphinx-build)
execute_process(COMMAND /usr/bin/python3 -c "import myst_parser" RESULT_VARIABLE no_myst ERROR_QUIET)
if(NOT sphinx OR no_myst)
  message("skipped: Sphinx with MyST is not installed: apt-get install python3-sphinx python3-myst-parser")
  return()
endif()

file(REMOVE_RECURSE ${BUILD}/site ${BUILD}/site.doctrees)
execute_process(
  COMMAND ${sphinx} -q -W --keep-going -b html -c ${SOURCE}/docs/site -d ${BUILD}/site.doctrees ${SOURCE} ${BUILD}/site
  RESULT_VARIABLE result ERROR_VARIABLE warnings)
file(REMOVE_RECURSE ${BUILD}/site.doctrees)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${warnings}")
endif()
file(REMOVE ${BUILD}/site/objects.inv ${BUILD}/site/.buildinfo)
if(EXISTS ${BUILD}/api/html/index.html)
  file(COPY ${BUILD}/api/html/ DESTINATION ${BUILD}/site/api)
  # Their first page is docs/library.md, which Doxygen puts elsewhere than its links know.
  file(READ ${BUILD}/site/api/index.html first)
  string(REGEX REPLACE "href=\"([a-z_/]+)\\.md([#\"])" "href=\"../docs/\\1.html\\2" first "${first}")
  file(WRITE ${BUILD}/site/api/index.html "${first}")
endif()
