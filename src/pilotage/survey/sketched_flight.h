#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/survey/plan_survey.h"
#include "pilotage/survey/survey_options.h"

namespace pilotage {

/// The flight over an area of which only the line is missing: what a route that is drawn on its page is predicted with.
/// Inertial system, limit, wind and tries are what `prepare` takes where the planner names none.
struct SketchedFlight {
  Mission mission;      ///< No route, no samples.
  Selection selection;  ///< What a tile needs to count, and how often a flight is to succeed; no tile.
  /// A mission file for `prepare` on the grid of the area, without the route; null where no P is known.
  nlohmann::ordered_json mission_file;
};

/// `scores` are those of the area's tiles, by `options` (with_usual_fine_contrast()). What was chosen for such a route,
/// and what is wrong with the imagery's own word on its error, goes to the notes and the warnings of the area.
SketchedFlight sketched_flight(SurveyedGround& area, const std::vector<TileScores>& scores,
                               const std::vector<std::string>& imagery, const SurveyOptions& options);

}  // namespace pilotage
