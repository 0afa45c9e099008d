#include "pilotage/survey/survey_layers.h"

#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/gis/degree_overlay.h"
#include "pilotage/gis/ground_layers.h"
#include "pilotage/gis/qgis_style.h"
#include "pilotage/mapdb/geopackage_rows.h"
#include "pilotage/raster/gdal_zip.h"

namespace pilotage {
namespace {

constexpr Rgb kSquareColor{0x20, 0x20, 0x20};

VectorLayer square_layer(const Survey& survey, const Crs& crs) {
  VectorLayer layer;
  layer.name = "squares";
  layer.title = "Square kilometres";
  layer.description = "Squares of the kilometre grid, with the share of each class of ground in them.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = crs;
  layer.columns = {{"east_km", VectorType::kInteger, "East [km]"},
                   {"north_km", VectorType::kInteger, "North [km]"},
                   {"area_km2", VectorType::kReal, "Surveyed [km²]"},
                   {"tiles", VectorType::kInteger, "Tiles"},
                   {"go_share", VectorType::kReal, "Share of go ground"},
                   {"marginal_share", VectorType::kReal, "Share of marginal ground"},
                   {"no_go_share", VectorType::kReal, "Share of no-go ground"},
                   {"median_p_correct_fix", VectorType::kReal, "Median P(correct fix)"},
                   {"reasons", VectorType::kText, "Weak because"}};
  layer.qml = qgis_outline_style(kSquareColor, 0.5);
  for (const SquareKilometre& square : survey.squares) {
    const AreaStatistics& statistics = square.statistics;
    const ClassCounts& tiles = statistics.tiles;
    VectorFeature feature;
    for (const auto& [east, north] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
      feature.points.emplace_back(1000.0 * static_cast<double>(square.east_km + east),
                                  1000.0 * static_cast<double>(square.north_km + north));
    }
    feature.values = {square.east_km,
                      square.north_km,
                      number_value(statistics.area_km2),
                      tiles.all(),
                      number_value(statistics.share(tiles.go)),
                      number_value(statistics.share(tiles.marginal)),
                      number_value(statistics.share(tiles.no_go)),
                      number_value(statistics.median_p_correct_fix),
                      weak_because(statistics)};
    feature.title = square.name();
    feature.note = "go " + percent_text(statistics.share(tiles.go)) + ", marginal " +
                   percent_text(statistics.share(tiles.marginal)) + ", no-go " +
                   percent_text(statistics.share(tiles.no_go));
    feature.style = {with_opacity(kSquareColor, "ff"), 2, ""};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

VectorLayer survey_table(const Survey& survey) {
  std::vector<std::pair<std::string, std::string>> rows = {{"title", survey.title},
                                                           {"software_version", survey.software_version},
                                                           {"headline", survey.headline},
                                                           {"detail", survey.detail},
                                                           {"assumptions", join(survey.assumptions, "; ")},
                                                           {"not_looked_at", survey.not_looked_at}};
  if (survey.landmarks) {
    rows.emplace_back("landmarks", survey.landmarks->said);
    rows.emplace_back("landmarks_assume", survey.landmarks->assumes);
  }
  return key_value_layer("survey", "Survey", "What the survey says of the area, and what that rests on.", rows,
                         survey.inputs);
}

/// Those with a shape.
std::vector<VectorLayer> drawn(const Survey& survey, const ScoreTable& table) {
  std::vector<VectorLayer> layers = {
      decision_layer(table.ground, survey.tiles), square_layer(survey, table.ground.crs),
      tile_layer(table.ground, survey.tiles, ground_tile_fields(survey.landmarks.has_value()),
                 shown_scale(survey.measures))};
  if (survey.landmarks) layers.push_back(landmark_layer(survey.landmarks->landmarks));
  for (VectorLayer& layer : layers) {
    std::vector<std::pair<std::string, std::string>> titles;
    for (const VectorColumn& column : layer.columns) titles.emplace_back(column.name, column.title);
    layer.qml = with_aliases(layer.qml, titles);
  }
  return layers;
}

}  // namespace

void write_survey_geopackage(const std::filesystem::path& path, const Survey& survey, const ScoreTable& table) {
  std::vector<VectorLayer> layers = drawn(survey, table);
  layers.push_back(survey_table(survey));
  write_geopackage(path, layers, geopackage_timestamp(), true);
}

void write_survey_kmz(const std::filesystem::path& path, const Survey& survey, const ScoreTable& table) {
  std::string document = kml_document(survey.title, drawn(survey, table));
  DegreeOverlay overlay = heat_overlay(table, shown_scale(survey.measures), false);
  document.insert(document.rfind("</Document>"), overlay.kml);  // GDAL writes no overlays
  std::vector<std::pair<std::string, std::string>> files{{"doc.kml", std::move(document)}};
  for (auto& picture : overlay.pictures) files.push_back(std::move(picture));
  write_zip(path, files, true);
}

}  // namespace pilotage
