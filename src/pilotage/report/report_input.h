#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/raster/raster.h"
#include "pilotage/report/evaluation_note.h"
#include "pilotage/report/flight_notes.h"
#include "pilotage/report/seen_frames.h"
#include "pilotage/report/tile_pictures.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {
struct MapLandmarks;
}  // namespace pilotage

#pragma GCC visibility push(default)

namespace pilotage {

/// Everything `report` shows. Coordinates x, y are those of the mission grid (`plan.ground.crs.wkt()`).
struct ReportInput {
  std::string title;  ///< Of the page; "" takes the route's name.
  Mission mission;
  std::vector<TileScores> scores;  ///< Of the ground's tiles, in their order.
  Selection selection;

  /// Overview of the imagery in the mission grid's CRS, CV_8UC3 (red, green, blue) or CV_8UC1, of any size; it may be
  /// empty. 1,000 to 4,000 pixels on the longer side are enough: the page carries at most 1,600.
  Raster imagery;

  TilePictures pictures;                     ///< Of plan.ground.tiles, in their order; may be empty.
  SeenFrames seen;                           ///< What the camera will see along the route; may have no frame.
  std::optional<EvaluationNote> evaluation;  ///< What the scores are worth, where that was measured.
  std::vector<Simulation> simulations;       ///< What `simulate` found of this plan; drawn fixes before frames.
  std::optional<EnvelopeNote> envelope;      ///< What `envelope` found of it.
  std::optional<ReplayNote> replay;          ///< What `replay` found of flights by it.
  /// Of the onboard map (mission/planned_landmarks.h); null where it has none.
  std::shared_ptr<const MapLandmarks> landmarks;

  /// Longitude and latitude of a point of the mission grid; NaN where it has none. A continuous function that can be
  /// inverted over the corridor. Called from one thread, some 10,000 times and four times per tile.
  std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map;

  nlohmann::ordered_json parameters =
      nlohmann::ordered_json::object();  ///< All options, as options_to_json gives them.
  std::vector<InputFile> inputs;
  std::string software_version;
  std::vector<std::string>
      assumptions;  ///< Sentences for the planner beyond the plan's warnings and the route's notes.
};

/// What of it is judged; refers to it.
inline JudgedPlan judged_plan(const ReportInput& input) {
  const FlownAgainstPlan* flown = input.replay && input.replay->flown ? &*input.replay->flown : nullptr;
  return {input.mission, input.scores, input.selection, input.simulations, flown};
}

}  // namespace pilotage

#pragma GCC visibility pop
