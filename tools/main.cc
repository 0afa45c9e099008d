#include <iostream>
#include <string>
#include <vector>

#include "commands.h"
#include "run_program.h"

int main(int argc, char** argv) {
  using namespace pilotage;
  std::vector<Command> commands{
      make_fetch_command(),          make_capture_command(),        make_prepare_command(),
      make_survey_command(),         make_reroute_command(),        make_simulate_command(),
      make_envelope_command(),       make_tile_command(),           make_score_command(),
      make_merge_command(),          make_select_command(),         make_build_command(),
      make_report_command(),         make_inspect_command(),        make_verify_command(),
      make_update_command(),         make_audit_command(),          make_match_command(),
      make_replay_command(),         make_compare_command(),        make_calibrate_command(),
      make_landmark_label_command(), make_landmark_train_command(), make_landmark_score_command(),
      make_completion_command(),     make_manual_command()};
  return run_program(std::move(commands), std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}
