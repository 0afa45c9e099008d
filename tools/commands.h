#pragma once

#include "command.h"

namespace pilotage {

// Each in its own command_<word>.cc; main.cc lists them by the way of the data.
Command make_capture_command();
Command make_fetch_command();
Command make_prepare_command();
Command make_survey_command();
Command make_reroute_command();
Command make_replay_command();
Command make_simulate_command();
Command make_envelope_command();
Command make_tile_command();
Command make_score_command();
Command make_merge_command();
Command make_select_command();
Command make_build_command();
Command make_report_command();
Command make_match_command();
Command make_inspect_command();
Command make_verify_command();
Command make_update_command();
Command make_audit_command();
Command make_compare_command();
Command make_calibrate_command();
Command make_landmark_label_command();
Command make_landmark_score_command();
Command make_landmark_train_command();
Command make_completion_command();
Command make_manual_command();

}  // namespace pilotage
