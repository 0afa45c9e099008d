# Lines of the pages can be read side by side with code: at most 140 characters, rows of tables at most 200. Code blocks
# and the option tables, which the program writes, are as long as they are.
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
file(GLOB pages RELATIVE ${SOURCE} ${SOURCE}/*.md)
foreach(folder docs maps schemas studies tests tools)
  file(GLOB_RECURSE found RELATIVE ${SOURCE} ${SOURCE}/${folder}/*.md)
  list(APPEND pages ${found})
endforeach()
list(LENGTH pages count)
if(count LESS 50)
  problem("only ${count} pages found")
endif()

# Characters, not bytes: the bytes that continue a character of UTF-8 are left out.
string(CONCAT program
  [[FNR == 1 { code = 0; options = 0 } ]]
  [[/^ *(```|~~~)/ { code = !code; next } ]]
  [[/<!-- options -->/ { options = 1 } ]]
  [[/<!-- \/options -->/ { options = 0 } ]]
  [[code { next } ]]
  [[{ text = $0; gsub(/[\200-\277]/, "", text); length_of_it = length(text); table = text ~ /^ *\|/ } ]]
  [[table && (options || length_of_it <= 200) { next } ]]
  [[length_of_it > 140 { print FILENAME ":" FNR ": " length_of_it " characters" }]])
execute_process(COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C awk "${program}" ${pages}
                WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  problem("awk failed: ${result}")
endif()
if(NOT found STREQUAL "")
  problem("${found}")
endif()
finish("at most 140 characters in a line of a page, 200 in a row of a table")
