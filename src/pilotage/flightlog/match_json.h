#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"

namespace pilotage {

/// The answer to one frame, as `pilotage match --json` prints it (schemas/match.schema.json): frame, status, reason,
/// fix, candidate (each null or an object, with its error where the truth is known), stats, milliseconds when they are
/// wanted, and what was taken from the picture. Covariances row by row; NaN is null.
nlohmann::ordered_json to_json(const FrameMatch& match, const std::vector<TakenField>& taken, bool timings = true);

/// The fields alone.
nlohmann::ordered_json to_json(const std::vector<TakenField>& taken);

/// The same for people, one line per thing.
std::string frame_match_text(const FrameMatch& match, bool timings = true);

/// One line for each field and tag, with the number of frames when there are several.
std::string taken_text(const std::vector<TakenField>& taken);

}  // namespace pilotage
