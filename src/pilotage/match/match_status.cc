#include "pilotage/match/match.h"

namespace pilotage {

std::string_view match_status_name(MatchStatus status) {
  switch (status) {
    case MatchStatus::kFix:
      return "fix";
    case MatchStatus::kBadFrame:
      return "bad_frame";
    case MatchStatus::kBadPrior:
      return "bad_prior";
    case MatchStatus::kBadCamera:
      return "bad_camera";
    case MatchStatus::kBadOptions:
      return "bad_options";
    case MatchStatus::kTooUncertain:
      return "too_uncertain";
    case MatchStatus::kOutOfTime:
      return "out_of_time";
    case MatchStatus::kNoMap:
      return "no_map";
    case MatchStatus::kMapUnreadable:
      return "map_unreadable";
    case MatchStatus::kNoGround:
      return "no_ground";
    case MatchStatus::kTooFewFeatures:
      return "too_few_features";
    case MatchStatus::kAmbiguous:
      return "ambiguous";
    case MatchStatus::kInconsistent:
      return "inconsistent";
    case MatchStatus::kOutsideGate:
      return "outside_gate";
    case MatchStatus::kOutOfMemory:
      return "out_of_memory";
  }
  return "unknown";
}

std::string_view match_status_text(MatchStatus status) {
  switch (status) {
    case MatchStatus::kFix:
      return "a fix";
    case MatchStatus::kBadFrame:
      return "the frame is not an 8-bit gray image of the camera's size";
    case MatchStatus::kBadPrior:
      return "the prior is not finite, not on Earth, or not above the ground";
    case MatchStatus::kBadCamera:
      return "the camera cannot be used";
    case MatchStatus::kBadOptions:
      return "an option is outside its range";
    case MatchStatus::kTooUncertain:
      return "the prior is so uncertain that the search would take more memory or work than is allowed";
    case MatchStatus::kOutOfTime:
      return "the deadline passed before there was an answer";
    case MatchStatus::kNoMap:
      return "the map holds no feature within the search window, and too few of its landmarks are seen";
    case MatchStatus::kMapUnreadable:
      return "the map is damaged here";
    case MatchStatus::kNoGround:
      return "the frame shows no ground";
    case MatchStatus::kTooFewFeatures:
      return "the frame or the map has too little texture";
    case MatchStatus::kAmbiguous:
      return "another place in the window looks as good, or another map says another place";
    case MatchStatus::kInconsistent:
      return "the best place explains too little of the frame";
    case MatchStatus::kOutsideGate:
      return "the best place contradicts the prior position, attitude or height";
    case MatchStatus::kOutOfMemory:
      return "there was not enough memory";
  }
  return "unknown status";
}

}  // namespace pilotage
