#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pilotage/ground/measure_scale.h"
#include "pilotage/report/height_profile.h"
#include "pilotage/report/landmark_note.h"
#include "pilotage/report/map_ageing.h"
#include "pilotage/report/report_input.h"
#include "pilotage/report/waypoints.h"
#include "pilotage/report/weak_places.h"
#include "pilotage/verdict/imagery_age.h"
#include "pilotage/verdict/quality.h"

#pragma GCC visibility push(default)

// The `report` stage: what a planner decides on. make_report() computes every number and sentence once; report_json()
// and report_html() only write them down, so that the page and the file for machines cannot disagree.

namespace pilotage {

/// A gap of the selection with its place on the ground.
struct ReportGap {
  RouteGap gap;
  double length_m = 0;
  double speed_mps = 0;  ///< Mean over the gap: length / duration; NaN when it has no duration.
  GeodeticPoint from;
  GeodeticPoint to;
  QualityStatus quality = QualityStatus::kGood;  ///< judge_gap.
};

/// A leg of the route with its place and its judgement (judge_leg).
struct ReportLeg {
  LegStatus status;
  double from_distance_m = 0;  ///< Along the route.
  GeodeticPoint from;
  GeodeticPoint to;
  int from_item = -1;  ///< Number by which QGroundControl shows the item where it begins; -1 where the file has none.
  int to_item = -1;
  QualityStatus quality = QualityStatus::kGood;
};

/// A tile of the plan with its score.
struct ReportTile {
  GroundTile tile;
  RoutePlace place;  ///< Along the route.
  TileScores score;
  bool selected = false;
  std::string reason;  ///< Why it is not selected, as one sentence; "" when it is.
  std::string
      reasons;  ///< Why it is not, or may not be, recognised (matchability/reasons.h); "" when nothing speaks so.
  std::string half_found_until;                                      ///< half_found_until() of map_holds.h.
  double p_landmark_fix = std::numeric_limits<double>::quiet_NaN();  ///< LandmarkNote::p_fix; NaN without landmarks.
};

/// A stretch of the route over selected tiles.
struct FixStretch {
  double from_distance_m = 0;
  double to_distance_m = 0;
};

/// What is drawn and is no number of its own: pictures and shapes in the plane of EPSG:3857 (docs/methods/report.md).
struct ReportDisplay {
  bool drawn = false;   ///< False where that plane does not reach (beyond 85.05° of latitude, no tile and no route).
  std::string missing;  ///< Why there is no map, as one sentence.
  double min_x_m = 0;   ///< Edges in EPSG:3857 metres; x may lie beyond ±20,037,508 when the corridor crosses 180°.
  double min_y_m = 0;
  double max_x_m = 0;
  double max_y_m = 0;
  std::string imagery_jpeg;   ///< Covers exactly these edges; "" without imagery.
  std::string pictures_jpeg;  ///< A sheet with one picture per tile of the report; "" without pictures.
  int picture_side_px = 0;    ///< Of a picture on that sheet.
  int picture_columns = 1;    ///< Pictures in a row of it.
  std::string seen_jpeg;      ///< The sheet of what the camera sees along the route; "" without frames.
  std::vector<std::array<Eigen::Vector2d, 4>> cells_m;           ///< Per tile of the report: the cell it stands for.
  std::vector<std::vector<Eigen::Vector2d>> leg_lines_m;         ///< Per leg of the report.
  std::vector<std::vector<Eigen::Vector2d>> gap_lines_m;         ///< Per gap of the report.
  std::vector<std::vector<Eigen::Vector2d>> denied_lines_m;      ///< Per denied stretch of the report.
  std::vector<std::vector<Eigen::Vector2d>> true_place_lines_m;  ///< Ellipses of its first simulation.
  std::vector<std::pair<double, Eigen::Vector2d>> places_m;      ///< Points by distance along the route, ascending.
};

/// How long the inertial system alone stays within the limit in straight flight (ins/drift.h); NaN where that is not
/// known.
struct InertialReach {
  double from_start_s = std::numeric_limits<double>::quiet_NaN();
  double after_fix_s = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = std::numeric_limits<double>::quiet_NaN();  ///< At which it was computed, that of the first sample.
};

struct Report {
  std::string title;
  std::string software_version;
  QualityStatus verdict = QualityStatus::kBad;  ///< Worst of the quality rows that decide; said as GO, MARGINAL, NO-GO.
  std::string verdict_text;                     ///< "NO-GO: matchable on 87 % of its length; longest gap 3.4 km = …".
  std::string headline;  ///< "95 of 100 flights stay within 60 m …". Like the detail, part of the text.
  std::string verdict_detail;
  std::string assumptions;  ///< "assumes: tactical INS (default), …": what the verdict takes for granted.
  std::vector<std::pair<std::string, std::string>> title_block;  ///< title_block.h. Not part of report.json.
  std::vector<QualityRow> quality;
  std::vector<WeakPlace> weak_places;  ///< Where to look first. Not part of report.json, which has the gaps and legs.

  std::string route_name;
  std::string route_format;
  double route_length_m = 0;
  double matchable_fraction = 0;
  double largest_error_m = 0;  ///< Largest predicted error (k·σ) of the route; NaN when there is none.
  double max_error_m = 0;      ///< The limit.
  double sigma_multiple = 3;
  HeightProfile heights;            ///< Not part of report.json.
  std::vector<Waypoint> waypoints;  ///< Not part of report.json.
  std::vector<ReportLeg> legs;
  std::vector<int> worst_legs;  ///< Indices into `legs`, at most ten: smallest probability, then largest error first.
  std::vector<ReportGap> gaps;
  std::optional<RouteProbability> probability;  ///< As the selection's.
  std::vector<DeniedStretch> denied;            ///< Where GNSS is; empty where it is lost at the first point.
  std::optional<LossAnywhere> loss_anywhere;    ///< As the selection's; `denied` begins at its worst point.
  InertialReach inertial_reach;                 ///< Not part of report.json.
  std::vector<FixStretch> fixes;
  std::vector<ErrorSample> error_profile;  ///< Thinned to at most 2,000 samples; extremes are kept.

  std::vector<MeasureScale> measures;
  std::vector<ReportTile> tiles;  ///< Ascending tile_id.
  std::int64_t selected_tiles = 0;
  std::int64_t estimated_bytes = 0;

  std::string crs_name;
  double max_scale_distortion = 0;
  double corridor_half_width_m = 0;
  double footprint_width_m = 0;
  double footprint_height_m = 0;
  std::vector<GridLevel> levels;
  std::vector<ImageryDataset> imagery;
  std::string elevation;
  std::vector<InputFile> inputs;
  std::optional<ImageryAge> imagery_age;  ///< Where the planner said when the flight is.
  std::optional<MapAgeing> ageing;        ///< Where P of the stored tiles counts the age of the imagery.
  std::optional<LandmarkNote> landmarks;  ///< Where the onboard map has some.
  nlohmann::ordered_json parameters;
  std::vector<std::string> warnings;
  std::vector<std::string> notes;
  std::optional<EvaluationNote> evaluation;  ///< Not part of report.json: it is a file of its own. So the next.
  std::vector<Simulation> simulations;
  std::optional<EnvelopeNote> envelope;
  std::optional<ReplayNote> replay;

  nlohmann::ordered_json sketch;   ///< What the page predicts a drawn line from (sketch.h). Not part of report.json.
  nlohmann::ordered_json what_if;  ///< What the page predicts other settings from (what_if.h). Not part of report.json.

  SeenFrames seen;        ///< As the input's, without its sheet. Not part of report.json.
  ReportDisplay display;  ///< Not part of report.json.
};

/// Joins plan, scores and selection and judges them. All text is made valid UTF-8 (bad bytes become U+FFFD).
/// Throws DataError when a score or a selected tile is not in the plan or comes twice, when a leg or level of the
/// selection or of a tile does not exist, when the samples of the route go backwards or the imagery is neither CV_8UC3
/// nor CV_8UC1.
Report make_report(const ReportInput& input);

/// report.json (schemas/report.schema.json). Numbers carry six significant digits, entropies twelve, coordinates seven
/// decimals; what is not defined is null.
nlohmann::ordered_json report_json(const Report& report);
inline nlohmann::ordered_json report_json(const ReportInput& input) {
  return report_json(make_report(input));
}

/// report.html: one page that needs no network and no other file.
std::string report_html(const Report& report);
inline std::string report_html(const ReportInput& input) {
  return report_html(make_report(input));
}

}  // namespace pilotage

#pragma GCC visibility pop
