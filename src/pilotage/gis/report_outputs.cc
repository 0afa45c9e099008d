#include "pilotage/gis/report_outputs.h"

#include <algorithm>
#include <iterator>

#include "pilotage/base/output_file.h"
#include "pilotage/gis/kml_files.h"
#include "pilotage/gis/report_layers.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/mapdb/geopackage_rows.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

std::string level_suffix(int level) {
  return level == 0 ? "" : "_level" + std::to_string(level);
}

const std::vector<std::string>& layer_names() {
  static const std::vector<std::string> names = {"tiles", "areas", "legs", "gaps", "route"};
  return names;
}

/// The score raster of its own and the class raster of every level that has scores.
std::vector<std::string> write_rasters(const fs::path& folder, const std::string& stem, const ReportInput& input,
                                       bool with_scores) {
  std::vector<std::string> names;
  const std::vector<TileRow> rows = tile_rows(input.plan.ground, input.scores);
  const Crs crs = input.plan.ground.crs;
  for (const GridLevel& level : input.plan.ground.levels) {
    const ScoreRaster raster = score_raster(level.matrix, rows);
    if (raster.bands.empty()) continue;
    const std::string suffix = level_suffix(level.matrix.level);
    if (with_scores) {
      const fs::path path = folder / (stem + "_scores" + suffix + ".tif");
      write_score_raster(path, raster.bands, crs, raster.map_from_pixel, true);
      names.push_back(path.filename().string());
      if (const auto shown = shown_measure(raster, input.scores)) {
        names.push_back(write_heat_style(path, *shown, true));
      }
    }
    const std::vector<std::string> written =
        write_classes(folder / (stem + "_classes" + suffix + ".tif"), class_values(level.matrix, rows), crs,
                      raster.map_from_pixel, true);
    names.insert(names.end(), written.begin(), written.end());
  }
  return names;
}

}  // namespace

bool asks_for(const std::vector<ReportOutput>& outputs, ReportOutput which) {
  return std::any_of(outputs.begin(), outputs.end(),
                     [&](ReportOutput output) { return output == which || output == ReportOutput::kAll; });
}

std::vector<std::string> report_output_names(const std::string& stem, const std::vector<ReportOutput>& outputs,
                                             const std::vector<GridLevel>& levels, bool with_scores) {
  std::vector<std::string> names;
  const auto add = [&](ReportOutput output, const std::string& rest) {
    if (asks_for(outputs, output)) names.push_back(stem + rest);
  };
  add(ReportOutput::kHtml, ".html");
  add(ReportOutput::kJson, ".json");
  for (const GridLevel& level : levels) {
    const std::string suffix = level_suffix(level.matrix.level);
    if (with_scores) {
      for (const char* rest : {".tif", ".qml"}) add(ReportOutput::kCog, "_scores" + suffix + rest);
    }
    for (const char* rest : {".tif", ".qml", ".tif.aux.xml"}) add(ReportOutput::kCog, "_classes" + suffix + rest);
  }
  add(ReportOutput::kGpkg, ".gpkg");
  add(ReportOutput::kKmz, ".kmz");
  for (const char* rest : {"_legs.kml", "_areas.kml"}) add(ReportOutput::kKml, rest);
  for (const std::string& layer : layer_names()) add(ReportOutput::kGeojson, "_" + layer + ".geojson");
  return names;
}

bool is_report_output(const std::string& stem, const std::string& name) {
  std::vector<GridLevel> levels(1);
  const auto at = name.find("_level");  // any level an earlier run may have had
  if (at != std::string::npos) levels.front().matrix.level = std::atoi(name.c_str() + at + 6);
  const std::vector<std::string> names = report_output_names(stem, {ReportOutput::kAll}, levels, true);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> write_report_outputs(const fs::path& folder, const std::string& stem, const ReportInput& input,
                                              const Report& report, const std::vector<ReportOutput>& outputs,
                                              bool with_scores, const Progress& progress) {
  std::vector<std::string> names;
  const auto path_of = [&](const std::string& rest) {
    names.push_back(stem + rest);
    return folder / names.back();
  };
  constexpr std::int64_t kSteps = 7;
  std::int64_t step = 0;
  const auto wanted = [&](ReportOutput output) {
    report_progress(progress, "writing the report", step++, kSteps);
    return asks_for(outputs, output);
  };
  const nlohmann::ordered_json numbers = report_json(report);
  const bool maps = asks_for(outputs, ReportOutput::kGpkg) || asks_for(outputs, ReportOutput::kKmz) ||
                    asks_for(outputs, ReportOutput::kKml) || asks_for(outputs, ReportOutput::kGeojson);
  const ReportLayers layers = maps ? report_layers(input, report, numbers) : ReportLayers{};

  if (wanted(ReportOutput::kHtml)) write_file(path_of(".html"), report_html(report), true);
  if (wanted(ReportOutput::kJson)) write_file(path_of(".json"), numbers.dump(1) + "\n", true);
  if (wanted(ReportOutput::kCog)) {
    std::vector<std::string> written = write_rasters(folder, stem, input, with_scores);
    std::move(written.begin(), written.end(), std::back_inserter(names));
  }
  if (wanted(ReportOutput::kGpkg)) {
    write_geopackage(path_of(".gpkg"),
                     {layers.tiles, layers.areas, layers.legs, layers.gaps, layers.route, layers.report},
                     geopackage_timestamp(), true);
  }
  if (wanted(ReportOutput::kKmz)) write_kmz(path_of(".kmz"), input, report, layers, true);
  if (wanted(ReportOutput::kKml)) {
    write_file(path_of("_legs.kml"), legs_kml(report, layers), true);
    write_file(path_of("_areas.kml"), areas_kml(report, layers), true);
  }
  if (wanted(ReportOutput::kGeojson)) {
    for (const VectorLayer* layer : {&layers.tiles, &layers.areas, &layers.legs, &layers.gaps, &layers.route}) {
      write_geojson(path_of("_" + layer->name + ".geojson"), *layer, true);
    }
  }
  report_progress(progress, "writing the report", kSteps, kSteps);
  return names;
}

}  // namespace pilotage
