# Adding a measure of a tile touches at most four modules (a .h with its .cc): the ones that compute it,
# ground/tile_scores.h and one row of ground/measures.cc. Everything that lists measures follows measures().
include(${CMAKE_CURRENT_LIST_DIR}/lint.cmake)
set(MOST_MODULES 4)

# Modules that decide something by a measure, or show one by itself. They do not grow with a new one; a module that
# copies measures from one place to another has no business here.
set(judges autopilot_sheet reasons matchability_model read_evaluation select_tiles tile_class quality report report_html report_layers
           strip_chart report_json compare_reports compare_reports_files selection selection_file ground_layers square_kilometres run_survey
           line_finder reroute_page what_if tile_chances evaluation predict_correct_fixes simulated_mission envelope predicted_tiles
           level_at_age map_ageing)
# Modules in which the word is something else: a surface that is no tile's, a footprint's width, a frame's features.
set(others_peak judge_by_ncc score_second_epoch)
set(others_margin ties score_second_epoch world)
set(others_half_width_px place_ranking displacement_voting frame_on_grid heading_ranking landmark_matching match)
set(others_map_features match match_json fix_table)
set(others_ncc ties warp_problem chip_search match_confidence match_json place_ranking fix_table match)
set(others_disagreement_m fit_warp score_outputs)
set(others_level_tiles verdict) # of a selection

file(READ ${SOURCE}/src/pilotage/ground/tile_scores.h text)
string(REGEX MATCHALL "double [a-z_0-9]+ = std::numeric_limits" members "${text}")
list(TRANSFORM members REPLACE "double ([a-z_0-9]+) =.*" "\\1")
list(REMOVE_DUPLICATES members)
list(LENGTH members count)
if(count LESS 20)
  problem("only ${count} measures found in ground/tile_scores.h: this lint reads it wrongly")
endif()

foreach(member IN LISTS members)
  execute_process(
    COMMAND grep -rlE --include=*.h --include=*.cc
            "(\\.|->|::)${member}[^a-z_0-9(]|double ${member}[ ;]" src tools
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    problem("grep for ${member} failed: ${result}")
  endif()
  string(REGEX REPLACE "\n$" "" found "${found}")
  string(REPLACE "\n" ";" found "${found}")
  list(TRANSFORM found REPLACE "\\.(h|cc)$" "")
  list(REMOVE_DUPLICATES found)
  set(modules "")
  foreach(module IN LISTS found)
    get_filename_component(stem ${module} NAME)
    if(NOT stem IN_LIST judges AND NOT stem IN_LIST others_${member})
      list(APPEND modules ${module})
    endif()
  endforeach()
  list(LENGTH modules count)
  if(count GREATER MOST_MODULES)
    list(JOIN modules ", " modules)
    problem("${member}: ${count} modules name it: ${modules}")
  endif()
  if(VERBOSE)
    message("${member} ${count}: ${modules}")
  endif()
endforeach()
finish("at most ${MOST_MODULES} modules name a measure but for those that judge by it; lists follow measures()")
