#include <cmath>
#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/report/ground_json.h"
#include "pilotage/report/report_file.h"
#include "pilotage/survey/survey.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json survey_number(double value) {
  return variant_to_json(number_value(value));
}

Json statistics_json(const AreaStatistics& statistics) {
  const ClassCounts& tiles = statistics.tiles;
  Json reasons = Json::object();
  for (const auto& [code, count] : statistics.reasons) reasons[options_detail::enum_to_name(code)] = count;
  return {{"area_km2", survey_number(statistics.area_km2)},
          {"tiles", tiles.all()},
          {"go_tiles", tiles.go},
          {"marginal_tiles", tiles.marginal},
          {"no_go_tiles", tiles.no_go},
          {"not_known_tiles", tiles.not_known},
          {"go_share", survey_number(statistics.share(tiles.go))},
          {"marginal_share", survey_number(statistics.share(tiles.marginal))},
          {"no_go_share", survey_number(statistics.share(tiles.no_go))},
          {"median_p_correct_fix", survey_number(statistics.median_p_correct_fix)},
          {"reasons", reasons}};
}

Json squares_json(const Survey& survey) {
  Json json = Json::array();
  for (const SquareKilometre& square : survey.squares) {
    Json next = {{"east_km", square.east_km},
                 {"north_km", square.north_km},
                 {"center_lon_deg", variant_to_json(degrees_value(square.center.lon_deg))},
                 {"center_lat_deg", variant_to_json(degrees_value(square.center.lat_deg))}};
    next.update(statistics_json(square.statistics));
    json.push_back(std::move(next));
  }
  return json;
}

Json landmarks_json(const Survey& survey) {
  const SurveyLandmarks& found = *survey.landmarks;
  const auto share = [&](std::int64_t tiles) { return survey_number(survey.statistics.share(tiles)); };
  return {{"classes", landmark_classes_json(found.classes)},
          {"likely_tiles", found.likely_tiles},
          {"likely_share", share(found.likely_tiles)},
          {"gaining_tiles", found.gaining_tiles},
          {"gaining_share", share(found.gaining_tiles)},
          {"said", found.said},
          {"assumes", found.assumes}};
}

Json camera_json_of(const SurveyedGround& area) {
  Json json = {{"name", area.camera_name}};
  for (const auto& [key, value] : camera_to_text(area.camera)) {
    const std::optional<double> number = parse_number(value);
    const bool whole = number && value.find_first_not_of("0123456789") == std::string::npos;
    json[key] = whole ? Json(static_cast<std::int64_t>(*number)) : number ? Json(*number) : Json(value);
  }
  return json;
}

std::string number_cell(double value) {
  return std::isfinite(value) ? format_number(rounded(value, 6)) : "";
}

}  // namespace

Json survey_json(const Survey& survey) {
  const SurveyedGround& area = survey.area;
  Json json = {{"format", "pilotage-survey"},
               {"format_version", kSurveyFormatVersion},
               {"software_version", survey.software_version},
               {"title", survey.title},
               {"headline", survey.headline},
               {"detail", survey.detail},
               {"assumptions", survey.assumptions},
               {"not_looked_at", survey.not_looked_at},
               {"classes", tile_classes_meaning()},
               {"area", statistics_json(survey.statistics)},
               {"farthest_from_go_m", survey_number(survey.farthest_from_go_m)},
               {"squares", squares_json(survey)},
               {"camera", camera_json_of(area)},
               {"agl_m", survey_number(area.agl_m)},
               {"footprint_width_m", survey_number(area.footprint_width_m)},
               {"footprint_height_m", survey_number(area.footprint_height_m)},
               {"search_radius_m", survey_number(area.search_radius_m)},
               {"matcher", flying_matcher_name(survey.matcher)},
               {"model", survey.model},
               {"measures", measures_json(survey.measures)},
               {"grid",
                {{"crs", area.ground.crs.name()},
                 {"max_scale_distortion", survey_number(area.ground.max_scale_distortion)},
                 {"levels", levels_json(area.ground.levels)}}},
               {"imagery", imagery_json(area.ground.imagery.datasets)},
               {"second_dates", imagery_json(survey.second_dates)},
               {"elevation", name_as_utf8(area.ground.elevation)},
               {"inputs", inputs_json(survey.inputs)},
               {"parameters", survey.parameters},
               {"warnings", survey.warnings},
               {"notes", survey.notes}};
  if (survey.landmarks) json["landmarks"] = landmarks_json(survey);
  json["tiles"] = tiles_json(ground_tile_fields(survey.landmarks.has_value()), survey.tiles);
  return json;
}

std::string squares_csv(const Survey& survey) {
  std::string csv =
      "east_km,north_km,center_lon_deg,center_lat_deg,area_km2,tiles,go_tiles,marginal_tiles,no_go_tiles,"
      "not_known_tiles,go_share,marginal_share,no_go_share,median_p_correct_fix,reasons\n";
  for (const SquareKilometre& square : survey.squares) {
    const AreaStatistics& statistics = square.statistics;
    const ClassCounts& tiles = statistics.tiles;
    std::vector<std::string> cells = {std::to_string(square.east_km), std::to_string(square.north_km),
                                      format_fixed(square.center.lon_deg, 7), format_fixed(square.center.lat_deg, 7),
                                      number_cell(statistics.area_km2)};
    for (const std::int64_t count : {tiles.all(), tiles.go, tiles.marginal, tiles.no_go, tiles.not_known}) {
      cells.push_back(std::to_string(count));
    }
    for (const std::int64_t count : {tiles.go, tiles.marginal, tiles.no_go}) {
      cells.push_back(number_cell(statistics.share(count)));
    }
    cells.push_back(number_cell(statistics.median_p_correct_fix));
    cells.push_back(join(reason_names(statistics.reasons), ";"));
    csv += join(cells, ",") + "\n";
  }
  return csv;
}

}  // namespace pilotage
