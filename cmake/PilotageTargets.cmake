# How our own targets are compiled: warnings; that they are errors, sanitizers and assertions by option.

# Floating-point contraction is off so that the same source gives the same numbers whether or not the compiler may use FMA.
add_library(pilotage_compile_options INTERFACE)
target_compile_options(pilotage_compile_options INTERFACE
  -Wall -Wextra -Wpedantic $<$<BOOL:${PILOTAGE_WARNINGS_ARE_ERRORS}>:-Werror> -Wshadow -Wnon-virtual-dtor -Wold-style-cast
  -Wcast-qual -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # "literal" + std::string at -O3 is taken for overlapping memory: https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105651
  target_compile_options(pilotage_compile_options INTERFACE -Wno-restrict)
endif()
# CMAKE_CXX_FLAGS_RELEASE brings -DNDEBUG; the presets that want assertions take it back.
if(PILOTAGE_ASSERTIONS)
  target_compile_options(pilotage_compile_options INTERFACE -UNDEBUG)
  target_compile_definitions(pilotage_compile_options INTERFACE _GLIBCXX_ASSERTIONS)
endif()
if(PILOTAGE_SANITIZE)
  add_compile_options(-fsanitize=${PILOTAGE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PILOTAGE_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Of std::regex, once instrumented: https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105562
    target_compile_options(pilotage_compile_options INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
if(PILOTAGE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "PILOTAGE_FUZZ needs clang; use the preset fuzz")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# pilotage_compile_by_folder(<target>): the sources of a folder are compiled as one, for most of their time would go into the same
# headers of OpenCV, Eigen and GDAL. So names in anonymous namespaces are unique within a folder. -DCMAKE_UNITY_BUILD=OFF compiles each alone.
function(pilotage_compile_by_folder target)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(GET folder FILENAME folder)
    set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# pilotage_embed_page(<folder> [<file>…] [AS <name>=<file>…] [HEADER <file>]): files of the calling folder become functions of pilotage::page_assets in
# pilotage_prep, named as they are with "_" for "."; those after AS, with whole paths, have the names given. pilotage/<folder>/<folder>_assets.h
# declares them, or the HEADER named.
function(pilotage_embed_page folder)
  cmake_parse_arguments(PARSE_ARGV 1 page "" "HEADER" "AS")
  set(names "")
  set(files "")
  foreach(file IN LISTS page_UNPARSED_ARGUMENTS)
    string(REPLACE "." "_" name ${file})
    list(APPEND names ${name})
    list(APPEND files ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  foreach(named IN LISTS page_AS)
    string(REGEX MATCH "^([^=]+)=(.+)$" _ ${named})
    list(APPEND names ${CMAKE_MATCH_1})
    list(APPEND files ${CMAKE_MATCH_2})
  endforeach()
  if(NOT page_HEADER)
    set(page_HEADER ${folder}_assets.h)
  endif()
  set(assets_cc ${CMAKE_CURRENT_BINARY_DIR}/${folder}_assets.cc)
  add_custom_command(OUTPUT ${assets_cc}
    COMMAND ${CMAKE_COMMAND} "-DOUTPUT=${assets_cc}" "-DHEADER=pilotage/${folder}/${page_HEADER}"
            "-DNAMESPACE=pilotage::page_assets" "-DNAMES=$<JOIN:${names},|>" "-DFILES=$<JOIN:${files},|>"
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding the page of ${folder}" VERBATIM)
  # A rule of this folder is not seen by the target of the parent folder, so the two are tied by a target of its own.
  add_custom_target(pilotage_${folder}_page DEPENDS ${assets_cc})
  add_dependencies(pilotage_prep pilotage_${folder}_page)
  target_sources(pilotage_prep PRIVATE ${assets_cc})
endfunction()

# The tests are of two tiers (docs/decisions/checks-in-tests.md). `tools/test` runs those without the label "thorough"; `tools/test --all` runs
# all of them, and builds besides what is left out of the target `all`: the programs that only thorough tests run, and benchmarks.

# pilotage_thorough_tests(<test>...): these tests are run by `tools/test --all` only.
function(pilotage_thorough_tests)
  set_property(TEST ${ARGN} APPEND PROPERTY LABELS thorough)
endfunction()

# pilotage_thorough_programs(<target>...): these are built by `tools/test --all` only, by the target thorough_programs.
function(pilotage_thorough_programs)
  set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL ON)
  add_dependencies(thorough_programs ${ARGN})
endfunction()

# pilotage_add_tests(<folder> [THOROUGH] <file>_test.cc ...): one GoogleTest program per source folder, compiled as one, which is the test
# <folder>.unit; with THOROUGH its suites whose names end so are the test <folder>.thorough instead. Each leaves its cases in
# Testing/cases/<test>.xml, where tests/testing/summary.py counts them. A process per case would load 160 libraries each time.
function(pilotage_add_tests folder)
  cmake_parse_arguments(PARSE_ARGV 1 tests THOROUGH "" "")
  add_executable(test_${folder} ${tests_UNPARSED_ARGUMENTS})
  target_link_libraries(test_${folder} PRIVATE pilotage_testing pilotage_compile_options GTest::gmock_main)
  target_include_directories(test_${folder} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  set(tests ${folder}.unit)
  set(filter "")
  if(tests_THOROUGH)
    set(filter "--gtest_filter=-*Thorough.*")
    add_test(NAME ${folder}.thorough COMMAND test_${folder} --gtest_filter=*Thorough.*)
    list(APPEND tests ${folder}.thorough)
  endif()
  add_test(NAME ${folder}.unit COMMAND test_${folder} ${filter})
  set(labels unit)
  if(folder IN_LIST PILOTAGE_SANITIZED)
    list(APPEND labels sanitized)
    add_dependencies(sanitized_tests test_${folder})
  endif()
  foreach(test IN LISTS tests)
    set_tests_properties(${test} PROPERTIES LABELS "${labels}" COST 50 TIMEOUT 1500 FAIL_REGULAR_EXPRESSION " 0 tests from 0 test suites ran"
                         ENVIRONMENT "GTEST_OUTPUT=xml:${PROJECT_BINARY_DIR}/Testing/cases/${test}.xml")
  endforeach()
  if(tests_THOROUGH)
    pilotage_thorough_tests(${folder}.thorough)
  endif()
endfunction()
