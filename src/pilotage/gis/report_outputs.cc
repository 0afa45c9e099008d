#include "pilotage/gis/report_outputs.h"

#include <algorithm>
#include <charconv>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/gis/imagery_tiles.h"
#include "pilotage/gis/kml_files.h"
#include "pilotage/gis/pmtiles.h"
#include "pilotage/gis/report_layers.h"
#include "pilotage/gis/score_files.h"
#include "pilotage/gis/stac_item.h"
#include "pilotage/mapdb/geopackage_rows.h"
#include "pilotage/report/autopilot_sheet.h"
#include "pilotage/route/dji_wpml_writer.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

std::string level_suffix(int level) {
  return level == 0 ? "" : "_level" + std::to_string(level);
}

using Endings = std::vector<std::string>;

/// What a format is written from, and where.
struct OutputSource {
  fs::path folder;
  std::string stem;
  const ReportInput& input;
  const Report& report;
  const ReportLayers& layers;  ///< Empty when no format that is asked for draws layers.
  bool with_scores = false;
  const std::vector<ReportOutput>& outputs;
  int threads = 0;
  const Progress& progress;
  std::vector<std::string> written{};  ///< Names of the files that the formats before wrote.

  fs::path path(const std::string& ending) const { return folder / (stem + ending); }
};

/// A way to hand the report on. Endings are what stands behind the stem in the names of its files.
struct OutputFormat {
  ReportOutput output;
  std::string name;
  std::string purpose;  ///< For the help: "QGIS"; "" for none.
  bool draws_layers = false;
  Endings (*endings)(const std::vector<GridLevel>& levels, bool with_scores);
  Endings (*write)(const OutputSource& source);  ///< Returns the endings of the files written.
};

Endings write_html(const OutputSource& source) {
  write_file(source.path(".html"), report_html(source.report), true);
  return {".html"};
}

Endings write_json(const OutputSource& source) {
  write_file(source.path(".json"), json_text(report_json(source.report)), true);
  return {".json"};
}

Endings raster_endings(const std::vector<GridLevel>& levels, bool with_scores) {
  Endings endings;
  for (const GridLevel& level : levels) {
    const std::string suffix = level_suffix(level.matrix.level);
    if (with_scores) {
      for (const char* type : {".tif", ".qml"}) endings.push_back("_scores" + suffix + type);
    }
    for (const char* type : {".tif", ".qml", ".tif.aux.xml"}) endings.push_back("_classes" + suffix + type);
  }
  return endings;
}

/// The score raster of its own and the class raster of every level that has scores.
Endings write_rasters(const OutputSource& source) {
  Endings endings;
  const ScoreTable table(source.input.mission.ground, source.input.scores);
  const Crs crs = source.input.mission.ground.crs;
  for (const GridLevel& level : source.input.mission.ground.levels) {
    const ScoreRaster raster = score_raster(table, level.matrix.level);
    if (raster.bands.empty()) continue;
    const std::string suffix = level_suffix(level.matrix.level);
    if (source.with_scores) {
      const fs::path path = source.path("_scores" + suffix + ".tif");
      write_score_raster(path, raster.bands, crs, raster.map_from_pixel, true);
      endings.push_back("_scores" + suffix + ".tif");
      if (const auto shown = shown_measure(raster, source.input.scores)) {
        write_heat_style(path, *shown, true);
        endings.push_back("_scores" + suffix + ".qml");
      }
    }
    write_classes(source.path("_classes" + suffix + ".tif"), class_values(table, level.matrix.level), crs,
                  raster.map_from_pixel, true);
    for (const char* type : {".tif", ".qml", ".tif.aux.xml"}) endings.push_back("_classes" + suffix + type);
  }
  return endings;
}

Endings write_gpkg(const OutputSource& source) {
  const ReportLayers& layers = source.layers;
  std::vector<VectorLayer> written = {layers.decision};
  for (const VectorLayer* layer : drawn_layers(layers)) written.push_back(*layer);
  written.push_back(layers.report);
  write_geopackage(source.path(".gpkg"), written, geopackage_timestamp(), true);
  return {".gpkg"};
}

Endings write_google_earth(const OutputSource& source) {
  write_kmz(source.path(".kmz"), source.input, source.report, source.layers, true);
  return {".kmz"};
}

Endings write_kml(const OutputSource& source) {
  write_file(source.path("_legs.kml"), legs_kml(source.report, source.layers), true);
  write_file(source.path("_areas.kml"), areas_kml(source.report, source.layers), true);
  return {"_legs.kml", "_areas.kml"};
}

Endings write_route(const OutputSource& source) {
  write_file(source.path("_route.kml"), route_kml(source.report, source.layers), true);
  return {"_route.kml"};
}

/// As the options of `prepare` name it; "" where they do not, and of a report by itself.
std::string named_camera(const ReportInput& input) {
  const auto camera = input.parameters.find("camera");
  if (camera == input.parameters.end() || !camera->is_object() || !camera->contains("name")) return "";
  return camera->at("name").get<std::string>();
}

/// None for a route that a DJI mission cannot hold, unless it was asked for by name.
Endings write_dji(const OutputSource& source) {
  DjiMission mission;
  try {
    const Route& route = source.input.mission.flight.route;
    mission = dji_mission_of(route, camera_product_of(named_camera(source.input), route));
  } catch (const DataError&) {
    const auto& outputs = source.outputs;
    if (std::find(outputs.begin(), outputs.end(), ReportOutput::kDji) != outputs.end()) throw;
    return {};
  }
  write_dji_mission(source.path("_dji.kmz"), mission, true);
  return {"_dji.kmz"};
}

/// The file ending by which ground stations know their autopilot's parameters.
constexpr const char* kPx4Ending = "_autopilot.params";
constexpr const char* kArdupilotEnding = "_autopilot.param";

/// None where nobody said which autopilot it is.
Endings write_autopilot(const OutputSource& source) {
  const auto& autopilot = source.input.mission.flight.autopilot;
  if (!autopilot) return {};
  const char* ending = is_px4(*autopilot) ? kPx4Ending : kArdupilotEnding;
  write_file(source.path(ending), autopilot_parameters(source.input, source.report, *autopilot), true);
  return {ending};
}

/// Whether the tiles lie on both sides of the antimeridian.
bool over_antimeridian(const Ground& ground) {
  const auto [west, east] =
      std::minmax_element(ground.tiles.begin(), ground.tiles.end(),
                          [](const GroundTile& a, const GroundTile& b) { return a.center.lon_deg < b.center.lon_deg; });
  return !ground.tiles.empty() && east->center.lon_deg - west->center.lon_deg > 180;
}

/// The heat map of every level that has one. None over the antimeridian, where EPSG:3857 ends: the picture would go
/// around the world.
Endings write_heat_maps(const OutputSource& source) {
  Endings endings;
  if (over_antimeridian(source.input.mission.ground)) return endings;
  const ScoreTable table(source.input.mission.ground, source.input.scores);
  for (const GridLevel& level : source.input.mission.ground.levels) {
    const ScoreRaster raster = score_raster(table, level.matrix.level);
    if (raster.bands.empty()) continue;
    const auto shown = shown_measure(raster, source.input.scores);
    if (!shown) continue;
    endings.push_back(level_suffix(level.matrix.level) + ".mbtiles");
    write_heat_mbtiles(source.path(endings.back()), raster, *shown, source.input.mission.ground.crs,
                       source.report.title, true);
  }
  return endings;
}

Endings mbtiles_endings(const std::vector<GridLevel>& levels, bool /*with_scores*/) {
  Endings endings;
  for (const GridLevel& level : levels) endings.push_back(level_suffix(level.matrix.level) + ".mbtiles");
  return endings;
}

constexpr const char* kImageryMbtiles = "_imagery.mbtiles";
constexpr const char* kImageryPmtiles = "_imagery.pmtiles";

/// Who is to be named with the imagery, each once, and the licences: HTML, as web maps take it.
std::string attribution_of(const Imagery& imagery) {
  std::vector<std::string> texts;
  for (const ImageryDataset& dataset : imagery.datasets) {
    const std::string text = html_escape(licence_text(dataset.licence));
    if (!text.empty() && std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  return join(texts, " | ");
}

/// What a person sees on the way, in the field. None where the web's maps end, or no tile has imagery.
Endings write_imagery(const OutputSource& source) {
  const Ground& ground = source.input.mission.ground;
  const std::vector<WebTile> tiles = imagery_tiles_of(ground);
  if (tiles.empty()) return {};
  const ImageryTilesText text{source.report.title, "The imagery that the map was made of, along the route",
                              attribution_of(ground.imagery)};
  if (!write_imagery_mbtiles(source.path(kImageryMbtiles), ground.imagery, tiles, text, true, source.threads,
                             source.progress)) {
    return {};
  }
  write_pmtiles(source.path(kImageryPmtiles), source.path(kImageryMbtiles), true);
  return {kImageryMbtiles, kImageryPmtiles};
}

/// Last of all: its assets are the others, and the map database where it lies beside them.
Endings write_stac(const OutputSource& source) {
  constexpr const char* kMap = "map.gpkg";
  std::vector<std::string> files = source.written;
  std::error_code error;
  if (fs::is_regular_file(source.folder / kMap, error)) files.insert(files.begin(), kMap);
  write_file(source.path("_stac.json"), stac_item(source.input, source.report, files), true);
  return {"_stac.json"};
}

Endings write_geojsons(const OutputSource& source) {
  Endings endings;
  for (const VectorLayer* layer : drawn_layers(source.layers)) {
    endings.push_back("_" + layer->name + ".geojson");
    write_geojson(source.path(endings.back()), *layer, true);
  }
  return endings;
}

/// The formats in the order in which they are written.
const std::vector<OutputFormat>& output_formats() {
  using Levels = const std::vector<GridLevel>&;
  static const std::vector<OutputFormat> formats = {
      {ReportOutput::kHtml, "html", "", false, [](Levels, bool) { return Endings{".html"}; }, write_html},
      {ReportOutput::kJson, "json", "", false, [](Levels, bool) { return Endings{".json"}; }, write_json},
      {ReportOutput::kCog, "cog", "heat map and classes", false, raster_endings, write_rasters},
      {ReportOutput::kGpkg, "gpkg", "QGIS", true, [](Levels, bool) { return Endings{".gpkg"}; }, write_gpkg},
      {ReportOutput::kKmz, "kmz", "Google Earth", true, [](Levels, bool) { return Endings{".kmz"}; },
       write_google_earth},
      {ReportOutput::kKml, "kml", "QGroundControl", true,
       [](Levels, bool) {
         return Endings{"_legs.kml", "_areas.kml"};
       },
       write_kml},
      {ReportOutput::kRoute, "route", "KML with the plan's numbers", true,
       [](Levels, bool) { return Endings{"_route.kml"}; }, write_route},
      {ReportOutput::kDji, "dji", "DJI mission", false, [](Levels, bool) { return Endings{"_dji.kmz"}; }, write_dji},
      {ReportOutput::kAutopilot, "autopilot", "its parameters, of --autopilot", false,
       [](Levels, bool) {
         return Endings{kPx4Ending, kArdupilotEnding};
       },
       write_autopilot},
      {ReportOutput::kGeojson, "geojson", "", true,
       [](Levels, bool) {
         return Endings{"_tiles.geojson", "_areas.geojson",  "_legs.geojson",
                        "_gaps.geojson",  "_denied.geojson", "_route.geojson"};
       },
       write_geojsons},
      {ReportOutput::kMbtiles, "mbtiles", "heat map for web maps", false, mbtiles_endings, write_heat_maps},
      {ReportOutput::kImagery, "imagery", "for ground stations", false,
       [](Levels, bool) {
         return Endings{kImageryMbtiles, kImageryPmtiles};
       },
       write_imagery},
      {ReportOutput::kStac, "stac", "item for a catalogue", false, [](Levels, bool) { return Endings{"_stac.json"}; },
       write_stac},
      {ReportOutput::kPack, "pack", "signed folder for the field, of prepare", false,
       [](Levels, bool) { return Endings{}; }, [](const OutputSource&) { return Endings{}; }}};
  return formats;
}

/// The level that a name of one of our files carries, 0 without one: any level an earlier run may have had.
int level_in(const std::string& name) {
  constexpr std::string_view kMark = "_level";
  const std::size_t at = name.find(kMark);
  int level = 0;
  if (at != std::string::npos) std::from_chars(name.data() + at + kMark.size(), name.data() + name.size(), level);
  return level;
}

}  // namespace

EnumNames<ReportOutput> enum_names(ReportOutput) {
  EnumNames<ReportOutput> names;
  for (const OutputFormat& format : output_formats()) names.push_back({format.output, format.name});
  names.push_back({ReportOutput::kAll, "all"});
  return names;
}

const std::string& outputs_help() {
  static const std::string help = [] {
    std::string text = "Files to write: ";
    for (const OutputFormat& format : output_formats()) {
      text += format.name + (format.purpose.empty() ? "" : " (" + format.purpose + ")") + ", ";
    }
    return text + "or all.";
  }();
  return help;
}

bool asks_for(const std::vector<ReportOutput>& outputs, ReportOutput which) {
  return std::any_of(outputs.begin(), outputs.end(), [&](ReportOutput output) {
    return output == which || (output == ReportOutput::kAll && which != ReportOutput::kPack);
  });
}

void refuse_unnamed_autopilot(const std::vector<ReportOutput>& outputs, const std::optional<Autopilot>& autopilot) {
  const bool is_named = std::find(outputs.begin(), outputs.end(), ReportOutput::kAutopilot) != outputs.end();
  if (!is_named || autopilot) return;
  std::string names;
  const auto known = enum_names(Autopilot{});
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (i > 0) names += i + 1 == known.size() ? " or " : ", ";
    names += known[i].name;
  }
  throw UsageError("--outputs autopilot: say which it is, --autopilot " + names);
}

std::optional<std::string> missing_imagery_warning(const std::vector<ReportOutput>& outputs,
                                                   const std::vector<std::string>& written) {
  const bool is_there = std::any_of(written.begin(), written.end(),
                                    [](const std::string& name) { return name.ends_with(kImageryMbtiles); });
  if (is_there || !asks_for(outputs, ReportOutput::kImagery)) return std::nullopt;
  return "no tiles of imagery are written: there is none over the plan's tiles, or they lie at the antimeridian or "
         "beyond 85° of latitude, where EPSG:3857 ends";
}

std::vector<std::string> report_output_names(const std::string& stem, const std::vector<ReportOutput>& outputs,
                                             const std::vector<GridLevel>& levels, bool with_scores) {
  std::vector<std::string> names;
  for (const OutputFormat& format : output_formats()) {
    if (!asks_for(outputs, format.output)) continue;
    for (const std::string& ending : format.endings(levels, with_scores)) names.push_back(stem + ending);
  }
  return names;
}

bool is_report_output(const std::string& stem, const std::string& name) {
  std::vector<GridLevel> levels(1);
  levels.front().matrix.level = level_in(name);
  const std::vector<std::string> names = report_output_names(stem, {ReportOutput::kAll}, levels, true);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> write_report_outputs(const fs::path& folder, const std::string& stem, const ReportInput& input,
                                              const Report& report, const std::vector<ReportOutput>& outputs,
                                              bool with_scores, int threads, const Progress& progress) {
  const std::vector<OutputFormat>& formats = output_formats();
  const bool draws_layers = std::any_of(formats.begin(), formats.end(), [&](const OutputFormat& format) {
    return format.draws_layers && asks_for(outputs, format.output);
  });
  const ReportLayers layers = draws_layers ? report_layers(input, report) : ReportLayers{};
  OutputSource source{folder, stem, input, report, layers, with_scores, outputs, threads, progress};
  const auto steps = static_cast<std::int64_t>(formats.size());
  std::int64_t step = 0;
  for (const OutputFormat& format : formats) {
    report_progress(progress, "writing the report", step++, steps);
    if (!asks_for(outputs, format.output)) continue;
    for (const std::string& ending : format.write(source)) source.written.push_back(stem + ending);
  }
  report_progress(progress, "writing the report", steps, steps);
  return source.written;
}

}  // namespace pilotage
