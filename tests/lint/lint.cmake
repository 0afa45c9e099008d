# What the lint scripts share. Input: SOURCE, the repository.
cmake_minimum_required(VERSION 3.25)
get_filename_component(SOURCE "${SOURCE}" ABSOLUTE)

set(problems "")
macro(problem text)
  string(APPEND problems "${text}\n")
endmacro()

# finish(<rule>): fails when there were problems, and says the rule again.
macro(finish rule)
  if(NOT problems STREQUAL "")
    message(FATAL_ERROR "${problems}Rule: ${rule}")
  endif()
endmacro()

# our_files(<variable> <glob>...): files below the repository, without build trees, relative to it and sorted.
function(our_files variable)
  set(found "")
  foreach(folder src tools maps tests)
    foreach(pattern IN LISTS ARGN)
      file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/${folder}/${pattern})
      list(APPEND found ${files})
    endforeach()
  endforeach()
  list(SORT found)
  set(${variable} ${found} PARENT_SCOPE)
endfunction()
