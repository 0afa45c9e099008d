#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/gdal_degrees.h"
#include "pilotage/reroute/reroute_options.h"
#include "pilotage/route/route.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

/// A line and what `prepare` says of it.
struct RerouteLine {
  QualityStatus verdict = QualityStatus::kBad;
  std::string verdict_text;              ///< As `prepare` prints it.
  std::string headline;                  ///< As the report's page has it, and
  std::string verdict_detail;            ///< what stands below it.
  std::optional<double> p_within_limit;  ///< RouteProbability's; nothing where no tile has a P.
  double largest_error_m = 0;            ///< Largest predicted error (k·σ).
  double matchable_fraction = 0;
  double length_m = 0;
  double duration_s = 0;
  int turns = 0;                      ///< Of more than 5°.
  double turned_deg = 0;              ///< All of them together.
  double no_fly_m = 0;                ///< Of its length, inside no-fly zones or outside the fence.
  std::vector<GeodeticPoint> points;  ///< Its vertices in the order of flight.
};

/// A tile of the ground that was searched, for the map.
struct SearchedTile {
  double p_fix = 0;  ///< 0 where none is counted on.
  std::vector<GeodeticPoint> corners;
};

struct RerouteResult {
  bool found_go = false;  ///< The new line is GO.
  RerouteLine before;
  RerouteLine after;
  std::string assumptions;      ///< Of the new line, as `prepare` prints them.
  std::vector<int> moved_legs;  ///< Of the planned line, counted from 0.
  double search_within_m = 0;
  std::int64_t tiles = 0;                  ///< Of the ground that was scored.
  int lines_tried = 0;                     ///< Held against the selection's own prediction.
  int lines_verified = 0;                  ///< Planned, scored and selected as `prepare` does.
  std::vector<std::string> removed_items;  ///< MovedPlan's.
  std::vector<std::string> lost_items;
  std::vector<std::string> shifted_items;
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
  std::vector<std::string> files;  ///< Written, beside each other.

  std::vector<SearchedTile> searched;
  DegreePicture imagery;                                 ///< Of the ground that was searched.
  std::vector<std::vector<GeodeticPoint>> no_fly_rings;  ///< Outlines and holes of what must not be entered,
  std::vector<std::vector<GeodeticPoint>> fence_rings;   ///< and of what must not be left.
};

struct RerouteRun {
  /// The new plan, "better.plan", or "better.kmz" for a DJI mission besides; the other files have its name with other
  /// endings.
  std::filesystem::path output;
  bool overwrite = false;
  std::uint64_t seed = 1;
  int threads = 0;
};

/// The files that reroute() writes for an output of this name: itself, .plan, .json, .geojson, .html.
std::vector<std::filesystem::path> reroute_outputs(const std::filesystem::path& output);

/// The cheapest line from the start of a planned one to its end on which the flight is GO, and a QGroundControl plan of
/// it: plan and score the ground around the planned line, search (line_search.h), straighten, and hold what was found
/// against the selection; then plan, score and select the new plan as `prepare` does, whose verdict and figures are
/// those of the result. Where no line is GO, the best that was found. docs/methods/reroute.md.
///
/// Legs that stay are those of options.line.keep; those that lead to a takeoff; and those of a survey, circle or
/// landing pattern. The search believes GNSS to be lost at the first point, wherever options.mission.tile.denied says.
///
/// Throws as the stages; UsageError for stretches of `denied` in kilometres, which another line does not have, for legs
/// to keep that do not exist or are all there are; as dji_mission_of() for a DJI mission; DataError when the start or
/// the end lies outside the imagery or in a no-fly zone, when both are nearer than a fifth of the way between them,
/// when a leg that is kept enters a zone, and when no line leads from the one to the other; as prepare() when an output
/// exists.
RerouteResult reroute(const RerouteOptions& options, const RerouteRun& run, const Progress& progress = {});

}  // namespace pilotage
