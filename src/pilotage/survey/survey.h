#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/report/landmark_classes.h"
#include "pilotage/report/report.h"
#include "pilotage/survey/plan_survey.h"
#include "pilotage/survey/sketched_flight.h"
#include "pilotage/survey/square_kilometres.h"

// What a survey says of an area. make_survey() computes every number and sentence once; survey_json(), survey_html()
// and survey_layers.h only write them down.

namespace pilotage {

/// Everything that a survey shows.
struct SurveyInput {
  std::string title;  ///< "" takes the imagery's name.
  SurveyedGround area;
  std::vector<TileScores> scores;  ///< Of the ground's tiles, in their order.
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  std::string model;  ///< File of the parameters of P(correct fix); "" for those that come with the program.
  std::optional<MapLandmarks> landmarks;  ///< On its tiles (mission/planned_landmarks.h).
  std::vector<ImageryDataset> second_dates;
  std::string second_date_assumption;  ///< What was taken for granted of it; "" without one.
  Raster imagery;                      ///< As ReportInput has them, and the next two.
  TilePictures pictures;
  std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map;
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  std::vector<InputFile> inputs;
  std::string software_version;
  SketchedFlight sketched;
};

/// What landmarks promise over the area. Modelled; the headline and the classes of ground do not count it.
struct SurveyLandmarks {
  MapLandmarks landmarks;
  std::vector<LandmarkClass> classes;
  std::int64_t likely_tiles = 0;         ///< P of a fix by landmarks alone is kLeastLandmarkGain at least.
  std::int64_t gaining_tiles = 0;        ///< Of these, those where it is more than P(correct fix), where that is known.
  std::optional<std::size_t> strongest;  ///< Tile where it is highest; nothing where it is 0 everywhere.
  std::string said;                      ///< All of this, as a sentence.
  std::string assumes;                   ///< landmark_assumption().
};

struct Survey {
  std::string title;
  std::string software_version;
  std::string go_share;                  ///< "41 %"
  std::string headline;                  ///< "a fix may be expected over 41 % of the area: 4.13 of 9.83 km²".
  std::string detail;                    ///< The other classes, the median of P, how far go ground is away.
  std::vector<std::string> assumptions;  ///< What the headline takes for granted, a phrase each.
  std::string not_looked_at;             ///< What it says nothing of.
  std::vector<std::pair<std::string, std::string>> title_block;

  AreaStatistics statistics;
  std::optional<std::size_t>
      strongest;  ///< Tiles where the first of `measures`, P(correct fix), is highest and lowest; nothing without one.
  std::optional<std::size_t> weakest;
  double farthest_from_go_m = 0;  ///< square_kilometres.h.
  std::vector<SquareKilometre> squares;

  std::optional<SurveyLandmarks> landmarks;
  std::vector<MeasureScale> measures;
  std::vector<ReportTile> tiles;  ///< Without what a flight would say of them. Ascending tile_id.
  SurveyedGround area;            ///< Its ground without tiles.
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  std::string model;
  std::vector<ImageryDataset> second_dates;
  std::vector<InputFile> inputs;
  nlohmann::ordered_json parameters;
  nlohmann::ordered_json
      sketch;  ///< What the page predicts a drawn line from (report/sketch.h). Not part of survey.json.
  std::vector<std::string> warnings;
  std::vector<std::string> notes;

  ReportDisplay display;
  std::vector<std::array<Eigen::Vector2d, 4>> square_corners_m;  ///< Of the squares, in the plane of the display.
};

/// The format of survey.json.
inline constexpr int kSurveyFormatVersion = 1;

/// Throws DataError when there is not one score for each tile.
Survey make_survey(const SurveyInput& input);

/// survey.json (schemas/survey.schema.json), numbers as report.json has them.
nlohmann::ordered_json survey_json(const Survey& survey);

/// survey.html: one page that needs no network and no other file.
std::string survey_html(const Survey& survey);

/// survey_squares.csv: a header line, then a line for each square kilometre.
std::string squares_csv(const Survey& survey);

/// "4.13 km²", "12.8 km²", "120 km²".
std::string area_text(double area_km2);

/// "open water (62 % of them), ground that repeats itself (20 %)" of the tiles that are not go, at most three; "" when
/// all are.
std::string weak_because(const AreaStatistics& statistics);

/// Names of reasons as tiles.csv has them, in the order of the counts, at most three.
std::vector<std::string> reason_names(const ReasonCounts& reasons);

}  // namespace pilotage
